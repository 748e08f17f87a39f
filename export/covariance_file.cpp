#include "export/covariance_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "export/trajectory_files.h"

namespace parkade {
namespace {

constexpr double kInterval = 0.1;  // [s]

std::string Header() {
  constexpr const char* kNames[] = {"rx", "ry", "rz", "x", "y", "z"};
  std::string header = "t [s]";
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column) {
      const char* unit = column < 3 ? "rad^2" : row < 3 ? "rad m" : "m^2";
      header += std::string(",") + kNames[row] + " " + kNames[column] + " [" + unit + "]";
    }
  return header + ",site x [m],site y [m],site z [m],site yaw [rad]\n";
}

void Append(double number, std::string& text) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, ",%.6e", number);
  text += buffer;
}

/// Covariance of the IMU's rotation and position, from that of the body's.
Eigen::Matrix<double, 6, 6> OfImu(const Eigen::Matrix<double, 6, 6>& covariance,
                                  const Rigid3& body_from_imu,
                                  const Eigen::Matrix3d& site_from_body) {
  // p_imu = p_body + R l moves by R (r x l) = -R [l]x r.
  const Eigen::Vector3d& lever = body_from_imu.translation;
  Eigen::Matrix3d cross;
  cross << 0, -lever.z(), lever.y(), lever.z(), 0, -lever.x(), -lever.y(), lever.x(), 0;
  Eigen::Matrix<double, 6, 6> moved_by = Eigen::Matrix<double, 6, 6>::Identity();
  moved_by.topLeftCorner<3, 3>() = body_from_imu.rotation.conjugate().toRotationMatrix();
  moved_by.bottomLeftCorner<3, 3>() = -site_from_body * cross;
  return moved_by * covariance * moved_by.transpose();
}

/// The state next in time; `states` are not empty.
const TrajectoryState& Nearest(const std::vector<TrajectoryState>& states, Timestamp time) {
  const auto after =
      std::lower_bound(states.begin(), states.end(), time,
                       [](const TrajectoryState& state, Timestamp t) { return state.time < t; });
  if (after == states.end()) return states.back();
  if (after == states.begin() || after->time - time < time - (after - 1)->time) return *after;
  return *(after - 1);
}

void AppendSigmas(const std::optional<SitePlacement>& placement, const Eigen::Vector3d& position,
                  std::string& text) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d sigma =
      placement ? placement->PositionSigma(position) : Eigen::Vector3d::Constant(unknown);
  for (const double value :
       {sigma.x(), sigma.y(), sigma.z(), placement ? placement->YawSigma() : unknown})
    Append(value, text);
}

}  // namespace

std::string EncodeCovarianceCsv(const SiteDrive& drive,
                                const std::optional<SitePlacement>& placement) {
  std::string text = Header();
  const std::vector<TimedPose> poses = SampleFinalTrajectory(drive);
  std::optional<Timestamp> last;
  size_t next = 0;
  for (const TrajectoryState& state : drive.odometry.states()) {
    if (last && state.time - *last < kInterval - 1e-6) continue;
    while (next < poses.size() && poses[next].time < state.time) ++next;
    if (next == poses.size()) break;
    if (poses[next].time != state.time) continue;
    last = state.time;
    const Rigid3& site_from_imu = poses[next].world_from_frame;
    const Eigen::Matrix3d site_from_body =
        (site_from_imu.rotation * drive.rig.body_from_imu.rotation.conjugate()).toRotationMatrix();
    const Eigen::Matrix<double, 6, 6> covariance =
        OfImu(Nearest(drive.site_from_body_trajectory.states(), state.time).covariance,
              drive.rig.body_from_imu, site_from_body);
    text += ToDecimalSeconds(state.time);
    for (Eigen::Index row = 0; row < 6; ++row)
      for (Eigen::Index column = row; column < 6; ++column) Append(covariance(row, column), text);
    AppendSigmas(placement, site_from_imu.translation, text);
    text += '\n';
  }
  return text;
}

}  // namespace parkade

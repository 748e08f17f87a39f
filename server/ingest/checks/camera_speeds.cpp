#include "server/ingest/checks/camera_speeds.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/rigid3.h"
#include "server/ingest/checks/pair_motion.h"

namespace parkade {
namespace {

constexpr double kAtOnce = 0.3;      // [s] within which pairs of cameras are of one moment
constexpr double kMinSine = 0.1;     // of a point's angle to the way; at the way it tells nothing
constexpr double kNear = 0.012;      // [rad] of a point from its epipolar plane
constexpr double kParallax = 0.005;  // [rad] from which on a point tells forward from backward
constexpr int kMinPoints = 40;

/// A pair's points as unit rays in the camera's axes, each at its own time.
struct SeenPair {
  const RigCamera* camera = nullptr;
  double seconds = 0;
  std::vector<Eigen::Vector3d> was, is;
};

/// All pairs of one moment.
struct Moment {
  Timestamp begin, end;
  std::vector<SeenPair> pairs;
  int num_points = 0;
  bool is_still = true;
};

/// (rate of the body [rad/s], speed of the rear axle [m/s])
using Motion = Eigen::Vector4d;

struct Residual {
  double distance = 0;  ///< [rad] from the epipolar plane
  bool moves_away = true;
};

std::vector<Residual> ResidualsBy(const Motion& motion, const Moment& moment) {
  std::vector<Residual> residuals;
  residuals.reserve(static_cast<std::size_t>(moment.num_points));
  for (const SeenPair& pair : moment.pairs) {
    const Eigen::Quaterniond turn = ExpSo3(pair.seconds * motion.head<3>());
    const Eigen::Vector3d way = WayOfCamera(*pair.camera, turn, pair.seconds * motion[3]);
    const Eigen::Quaterniond& body_from_camera = pair.camera->body_from_camera.rotation;
    const Eigen::Matrix3d first_from_second =
        (body_from_camera.conjugate() * turn * body_from_camera).toRotationMatrix();
    for (std::size_t i = 0; i < pair.was.size(); ++i) {
      const Eigen::Vector3d now = first_from_second * pair.is[i];
      const Eigen::Vector3d normal = pair.was[i].cross(way);
      const double sine = normal.norm();
      const bool tells = (now - pair.was[i]).norm() > kParallax;
      residuals.push_back({sine < kMinSine ? 0 : normal.dot(now) / sine,
                           !tells || now.dot(way) < pair.was[i].dot(way)});
    }
  }
  return residuals;
}

/// Gauss-Newton's steps on the points within a clip that narrows.
Motion Adjust(Motion motion, const Moment& moment) {
  constexpr double kSteps[4] = {1e-4, 1e-4, 1e-4, 1e-2};     // of the differences
  constexpr double kWeak[4] = {1e-7, 1e-7, 1e-7, 1e-7};      // what nothing tells stays as it is
  constexpr double kSlowest = 0.3, kFastest = 40;            // [m/s]
  for (const double clip : {0.15, 0.1, 0.06, 0.03, 0.02}) {  // [rad]
    const std::vector<Residual> residuals = ResidualsBy(motion, moment);
    std::array<std::vector<Residual>, 4> moved;
    for (int k = 0; k < 4; ++k) {
      Motion other = motion;
      other[k] += kSteps[k];
      moved[static_cast<std::size_t>(k)] = ResidualsBy(other, moment);
    }
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      if (std::abs(residuals[i].distance) > clip) continue;
      Eigen::Vector4d jacobian;
      for (int k = 0; k < 4; ++k)
        jacobian[k] =
            (moved[static_cast<std::size_t>(k)][i].distance - residuals[i].distance) / kSteps[k];
      information += jacobian * jacobian.transpose();
      gradient += residuals[i].distance * jacobian;
    }
    for (int k = 0; k < 4; ++k) information(k, k) += kWeak[k] * moment.num_points;
    motion -= information.ldlt().solve(gradient);
    motion[3] = std::copysign(std::clamp(std::abs(motion[3]), kSlowest, kFastest), motion[3]);
  }
  return motion;
}

/// How much a motion explains: points, and whole cameras.
struct Explained {
  int num_points = 0, num_cameras = 0, num_judged = 0;

  bool IsBelieved() const { return 2 * num_cameras > num_judged; }
};

Explained ExplainedBy(const Motion& motion, const Moment& moment) {
  constexpr int kMinOfCamera = 15;     // points
  constexpr double kExplained = 0.75;  // share of a camera's
  const std::vector<Residual> residuals = ResidualsBy(motion, moment);
  Explained explained;
  auto residual = residuals.begin();
  for (const SeenPair& pair : moment.pairs) {
    const auto end = residual + static_cast<std::ptrdiff_t>(pair.was.size());
    const auto count = std::count_if(residual, end, [](const Residual& of_point) {
      return std::abs(of_point.distance) < kNear && of_point.moves_away;
    });
    residual = end;
    explained.num_points += static_cast<int>(count);
    if (pair.was.size() < kMinOfCamera) continue;
    ++explained.num_judged;
    explained.num_cameras +=
        static_cast<double>(count) >= kExplained * static_cast<double>(pair.was.size()) ? 1 : 0;
  }
  return explained;
}

/// The motion that explains most; nothing where most cameras contradict it.
std::optional<Motion> MotionOf(const Moment& moment) {
  if (moment.num_points < kMinPoints) return std::nullopt;
  if (moment.is_still) return Motion::Zero();
  Motion best = Motion::Zero();
  Explained most;
  for (const double yaw_rate : {0.0, 0.25, -0.25, 0.5, -0.5})
    for (const double speed : {2.0, 8.0, -2.0}) {
      const Motion motion = Adjust({0, 0, yaw_rate, speed}, moment);
      const Explained explained = ExplainedBy(motion, moment);
      if (explained.num_points <= most.num_points) continue;
      most = explained;
      best = motion;
    }
  return most.IsBelieved() ? std::optional(best) : std::nullopt;
}

SeenPair RaysOf(const ImagePair& pair, const RigCamera& camera) {
  SeenPair seen{&camera, pair.second - pair.first, {}, {}};
  for (std::size_t i = 0; i < pair.from.size(); ++i) {
    const auto was = camera.model.Unproject(pair.from[i]), is = camera.model.Unproject(pair.to[i]);
    if (!was || !is) continue;
    seen.was.push_back(was->normalized());
    seen.is.push_back(is->normalized());
  }
  return seen;
}

std::vector<Moment> MomentsOf(const Rig& rig, const std::vector<ImagePairs>& pairs) {
  struct Entry {
    const ImagePair* pair;
    const RigCamera* camera;
  };
  std::vector<Entry> all;
  for (std::size_t camera = 0; camera < pairs.size(); ++camera)
    for (const ImagePair& pair : pairs[camera].pairs())
      all.push_back({&pair, &rig.cameras[camera]});
  std::stable_sort(all.begin(), all.end(),
                   [](const Entry& a, const Entry& b) { return a.pair->first < b.pair->first; });
  std::vector<Moment> moments;
  for (const auto& [pair, camera] : all) {
    if (moments.empty() || pair->first - moments.back().begin > kAtOnce)
      moments.push_back({pair->first, pair->second, {}});
    Moment& moment = moments.back();
    moment.end = std::max(moment.end, pair->second);
    moment.pairs.push_back(RaysOf(*pair, *camera));
    moment.num_points += static_cast<int>(moment.pairs.back().was.size());
    moment.is_still &= pair->IsStill();
  }
  return moments;
}

}  // namespace

SpeedHistory SpeedsByCameras(const Rig& rig, const std::vector<ImagePairs>& pairs) {
  constexpr double kStep = 0.05;       // [s] between samples
  constexpr double kSpeedSigma = 0.5;  // of a speed
  SpeedHistory history("the cameras", kSpeedSigma);
  for (const Moment& moment : MomentsOf(rig, pairs)) {
    const std::optional<Motion> motion = MotionOf(moment);
    if (!motion) continue;
    const int num_samples = static_cast<int>(std::ceil((moment.end - moment.begin) / kStep)) + 1;
    for (int i = 0; i < num_samples; ++i)
      history.Include({moment.begin + kStep * i, (*motion)[3], (*motion)[2]});
  }
  return history;
}

}  // namespace parkade

#include "server/pipeline/trajectory_findings.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace parkade {
namespace {

/// Two cameras or more that are off against the IMU by the same time say that the IMU is.
std::optional<Finding> ImuDelay(const std::vector<CameraCalibration>& cameras) {
  constexpr double kMinDelay = 0.01;   // [s] beyond what cables and drivers make of a camera
  constexpr double kMaxSpread = 0.25;  // of the delay, from one camera to the next
  std::vector<double> offsets;
  for (const CameraCalibration& camera : cameras)
    for (const CalibratedQuantity& quantity : camera.quantities)
      if (quantity.name == "time_offset" && quantity.status == CalibratedQuantity::Status::kRefined)
        offsets.push_back(quantity.change[0]);
  if (offsets.size() < 2 || offsets.size() < cameras.size()) return std::nullopt;
  const auto [least, most] = std::minmax_element(offsets.begin(), offsets.end());
  const double delay = (*least + *most) / 2;
  if (std::abs(delay) < kMinDelay || *most - *least > kMaxSpread * std::abs(delay))
    return std::nullopt;
  const std::string amount = std::to_string(std::lround(1000 * std::abs(delay))) + " ms";
  return Finding{"imu_delay",
                 Severity::kNote,
                 "",
                 delay > 0 ? "the IMU's readings come " + amount +
                                 " late against all cameras, as behind a low-pass filter, and are "
                                 "used so"
                           : "the IMU's readings come " + amount +
                                 " early against all cameras, and are used so",
                 "correct its driver's stamps, or timeshift_cam_imu of all cameras",
                 {{"delay_s", delay}}};
}

/// What cameras see and the trajectory does not fit.
std::optional<Finding> Contradiction(const std::vector<CameraHealth>& cameras) {
  // Errors of points over what the tracker expects of them; sound drives have 0.2 to 0.6.
  constexpr double kLargestNoise = 1;
  std::vector<std::string> names;
  double largest = 0;
  for (const CameraHealth& camera : cameras) {
    if (camera.noise_scale < kLargestNoise) continue;
    names.push_back(camera.name);
    largest = std::max(largest, camera.noise_scale);
  }
  if (names.empty()) return std::nullopt;
  std::string named = names.front();
  for (std::size_t i = 1; i < names.size(); ++i)
    named += (i + 1 == names.size() ? " and " : ", ") + names[i];
  const bool are_most = 2 * names.size() > cameras.size();
  return WarningOf(
      "cameras_contradict_path",
      "what " + named + (names.size() == 1 ? " sees" : " see") +
          (are_most ? " fits no path that the IMU allows: the map may be wrong"
                    : " does not move as the car does, and hardly counts"),
      "check topics, lenses, mounts and whether images are turned or mirrored, and the IMU's axes",
      {{"noise_over_expected", largest}});
}

/// Parts of the path that no camera saw.
std::optional<Finding> BlindParts(const OdometryReport& odometry) {
  constexpr double kMinSeconds = 2, kMinAtOnce = 0.6;
  double seconds = 0;
  for (const DegradedInterval& interval : odometry.degraded) {
    if (!interval.reason.starts_with(kNoCamera) || interval.end - interval.begin < kMinAtOnce)
      continue;
    seconds += interval.end - interval.begin;
  }
  if (seconds < kMinSeconds) return std::nullopt;
  return WarningOf("path_without_images",
                   "no camera sees anything for " + DurationText(seconds) + ": " +
                       (odometry.has_wheels ? "IMU and wheels alone tell" : "the IMU alone tells") +
                       " the path there",
                   "", {{"seconds", seconds}});
}

/// A mount of the rig that the drive shows to be another.
std::optional<Finding> WrongMount(const CameraCalibration& camera) {
  constexpr double kLargest = 5, kSigmas = 5;  // [deg]
  constexpr double kDegree = 0.017453292519943295;
  for (const CalibratedQuantity& quantity : camera.quantities) {
    const double angle = quantity.change.norm();
    if (quantity.name != "rotation" || quantity.status == CalibratedQuantity::Status::kKept ||
        angle < std::max(kLargest * kDegree, kSigmas * quantity.sigma.minCoeff()))
      continue;
    return WarningOf("mount_off",
                     "camera " + camera.name +
                         FormatText(" looks %.0f degrees beside where the rig says, as it seems",
                                    angle / kDegree),
                     "calibrate the rig again; images may be cropped, too",
                     {{"angle_deg", angle / kDegree}});
  }
  return std::nullopt;
}

}  // namespace

std::vector<Finding> TrajectoryFindings(const OdometryReport& odometry,
                                        const std::string& gnss_doubt) {
  constexpr double kManyImages = 0.2;  // share of a camera's
  std::vector<Finding> findings;
  const auto add = [&findings](std::optional<Finding> found) {
    if (found) findings.push_back(std::move(*found));
  };
  if (!odometry.wheels_left_out.empty())
    findings.push_back({"wheels_contradict",
                        Severity::kWarning,
                        "",
                        "the wheels are left out: they " + odometry.wheels_left_out,
                        "",
                        {}});
  for (const CameraHealth& camera : odometry.cameras)
    if (kManyImages * camera.frames < camera.frames_rejected)
      findings.push_back({"camera_shows_nothing",
                          Severity::kWarning,
                          "",
                          "camera " + camera.name + " shows nothing new in " +
                              std::to_string(camera.frames_rejected) + " of " +
                              std::to_string(camera.frames) + " images: they are blank, or repeat",
                          "look whether it hangs or is covered",
                          {}});
  if (!gnss_doubt.empty())
    findings.push_back({"gnss_contradicts",
                        Severity::kWarning,
                        "",
                        "GNSS is left out: its fixes " + gnss_doubt,
                        "",
                        {}});
  add(Contradiction(odometry.cameras));
  add(BlindParts(odometry));
  for (const CameraCalibration& camera : odometry.calibration) add(WrongMount(camera));
  add(ImuDelay(odometry.calibration));
  return findings;
}

}  // namespace parkade

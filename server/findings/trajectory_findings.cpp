#include "server/findings/trajectory_findings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/findings/force_findings.h"

namespace parkade {
namespace {

constexpr double kSure = 5;  // sigmas
constexpr double kSureOfTurns = 3.5, kSureOfPlaces = 3.5;
constexpr double kDegree = 0.017453292519943295;

/// Two cameras or more that are off against the IMU by the same time say that the IMU is.
std::optional<Finding> ImuDelay(const std::vector<CameraCalibration>& cameras) {
  constexpr double kMinDelay = 0.01;   // [s] beyond what cables and drivers make of a camera
  constexpr double kMaxSpread = 0.25;  // of the delay, from one camera to the next
  std::vector<double> offsets;
  for (const CameraCalibration& camera : cameras)
    for (const CalibratedQuantity& quantity : camera.quantities)
      if (quantity.name == "time_offset" && quantity.status != CalibratedQuantity::Status::kKept &&
          std::abs(quantity.change[0]) > kSure * quantity.sigma[0])
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
    if (camera.frames_used == 0 || camera.noise_scale < kLargestNoise) continue;
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
struct WrongMount {
  std::string camera;
  Eigen::Vector3d turn_in_body;  ///< [rad]
};

std::vector<WrongMount> WrongMounts(const OdometryReport& odometry, const Rig& rig) {
  constexpr double kLargest = 5 * kDegree;
  std::vector<WrongMount> mounts;
  for (const CameraCalibration& calibration : odometry.calibration)
    for (const CalibratedQuantity& quantity : calibration.quantities) {
      if (quantity.name != "rotation" || quantity.status == CalibratedQuantity::Status::kKept ||
          quantity.change.norm() < std::max(kLargest, kSure * quantity.sigma.minCoeff()))
        continue;
      for (const RigCamera& camera : rig.cameras)
        if (camera.name == calibration.name)
          mounts.push_back(
              {camera.name, camera.body_from_camera.rotation * quantity.change.head<3>()});
    }
  return mounts;
}

/// All cameras, two or more, that are turned alike say that the IMU is.
std::optional<Finding> TurnedImu(const std::vector<WrongMount>& mounts, std::size_t num_cameras) {
  constexpr double kMaxSpread = 0.4;  // of the turn
  if (mounts.size() < 2 || mounts.size() < num_cameras) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const WrongMount& mount : mounts)
    mean += mount.turn_in_body / static_cast<double>(mounts.size());
  for (const WrongMount& mount : mounts)
    if ((mount.turn_in_body - mean).norm() > kMaxSpread * mean.norm()) return std::nullopt;
  int axis = 0;
  mean.cwiseAbs().maxCoeff(&axis);
  static constexpr const char* kAxes[] = {"rolled", "pitched", "yawed"};
  return WarningOf(
      "imu_turned",
      std::string("the IMU sits ") + kAxes[axis] +
          FormatText(" by %.0f degrees or more against all cameras and the car: the "
                     "map may be wrong",
                     mean.norm() / kDegree),
      "correct T_imu_body in vehicle.yaml and T_cam_imu of all cameras, or mount it as "
      "they say",
      {{"angle_deg", mean.norm() / kDegree}});
}

void AddWrongMounts(const OdometryReport& odometry, const Rig& rig,
                    std::vector<Finding>& findings) {
  const std::vector<WrongMount> mounts = WrongMounts(odometry, rig);
  if (std::optional<Finding> imu = TurnedImu(mounts, rig.cameras.size())) {
    findings.push_back(std::move(*imu));
    return;
  }
  for (const WrongMount& mount : mounts) {
    const double angle = mount.turn_in_body.norm() / kDegree;
    findings.push_back(WarningOf(
        "mount_off",
        "camera " + mount.camera +
            FormatText(" looks %.0f degrees beside where the rig says, as it seems", angle),
        "calibrate the rig again; images may be cropped, too", {{"angle_deg", angle}}));
  }
}

/// Turns that a gyroscope reads and cameras do not see.
std::optional<Finding> WrongTurns(const SensorAgreement& agreement) {
  constexpr double kSmallestGain = 0.01, kSmallestDelay = 0.03;  // share, [s]
  const double gain = agreement.turn_gain, delay = agreement.turn_delay;
  if (std::abs(gain) > std::max(kSmallestGain, kSureOfTurns * agreement.turn_gain_sigma))
    return WarningOf(
        "turns_contradict",
        FormatText("the gyroscope reads turns %.1f %% %s than the cameras see (to %.1f %%): "
                   "the map may be bent",
                   100 * std::abs(gain), gain > 0 ? "larger" : "smaller",
                   100 * agreement.turn_gain_sigma),
        "check gyroscope_scale in imu0.yaml, and the focal lengths of the lenses",
        {{"gain", gain}, {"gain_sigma", agreement.turn_gain_sigma}});
  if (std::abs(delay) > std::max(kSmallestDelay, kSureOfTurns * agreement.turn_delay_sigma))
    return WarningOf(
        "turns_late",
        FormatText("the gyroscope's rates come %.0f ms %s", 1000 * std::abs(delay),
                   delay > 0 ? "behind what the cameras see, as after a low-pass filter"
                             : "before what the cameras see"),
        "turn filters of the IMU off, and check its stamps",
        {{kDelay, delay}, {"delay_sigma_s", agreement.turn_delay_sigma}});
  return std::nullopt;
}

/// A camera that sits elsewhere than the rig says: the one that is off the most.
std::optional<Finding> WrongPlace(const SensorAgreement& agreement) {
  constexpr double kSmallest = 0.25;  // [m]
  const CameraLead* most = nullptr;
  for (const CameraLead& lead : agreement.leads)
    if (std::abs(lead.ahead) > std::max(kSmallest, kSureOfPlaces * lead.sigma) &&
        (!most || std::abs(lead.ahead) > std::abs(most->ahead)))
      most = &lead;
  if (!most) return std::nullopt;
  return WarningOf("place_off",
                   "camera " + most->camera +
                       FormatText(" sits %.1f m farther %s in the car than the rig says, as it "
                                  "seems by its way in turns: the map may be wrong",
                                  std::abs(most->ahead), most->ahead > 0 ? "ahead" : "back"),
                   "measure the places of all cameras again",
                   {{"ahead_m", most->ahead}, {"ahead_sigma_m", most->sigma}});
}

/// A body that is another point of the car than the middle of the rear axle.
std::optional<Finding> WrongBody(const SensorAgreement& agreement) {
  constexpr double kSmallest = 0.5;  // [m]
  const double ahead = agreement.body_lead;
  if (std::abs(ahead) < std::max(kSmallest, kSure * agreement.body_lead_sigma)) return std::nullopt;
  return WarningOf(
      "body_off",
      FormatText("in turns the rig's body moves like a point of the car %.1f m %s the "
                 "rear axle",
                 std::abs(ahead), ahead > 0 ? "ahead of" : "behind"),
      "check T_imu_body in vehicle.yaml, p_imu = T p_body: it may be the other way round",
      {{"ahead_m", ahead}, {"ahead_sigma_m", agreement.body_lead_sigma}});
}

std::optional<Finding> VagueFixes(const GnssVerdict& gnss) {
  if (gnss.num_too_vague == 0) return std::nullopt;
  return Finding{"gnss_vague",
                 Severity::kNote,
                 "",
                 "GNSS does not tell where on earth the drive is: its fixes (" +
                     std::to_string(gnss.num_too_vague) +
                     ") are too few, too vague for the way between them, or disagree",
                 "drive farther under open sky, or pin places of the map",
                 {{"num_fixes", static_cast<double>(gnss.num_too_vague)}}};
}

/// Fixes of which the trajectory allows one part or the other.
std::optional<Finding> SplitFixes(const GnssVerdict& gnss) {
  constexpr double kMany = 0.3;  // share of them
  const auto apart = static_cast<double>(gnss.num_apart);
  const auto all = static_cast<double>(gnss.num_used + gnss.num_apart);
  if (apart == 0 || apart < kMany * all) return std::nullopt;
  return WarningOf("gnss_split",
                   FormatText("GNSS contradicts itself: %.0f of %.0f fixes are left out, as the "
                              "trajectory does not allow them with the others: the map may lie "
                              "beside its place, or above or below",
                              apart, all),
                   "check the receiver for leaps of position and altitude",
                   {{"left_out", apart}, {"fixes", all}});
}

}  // namespace

std::vector<Finding> TrajectoryFindings(const OdometryReport& odometry, const Rig& rig,
                                        const SensorAgreement& agreement, const GnssVerdict& gnss) {
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
  if (!gnss.doubt.empty())
    findings.push_back({"gnss_contradicts",
                        Severity::kWarning,
                        "",
                        "GNSS is left out: its fixes " + gnss.doubt,
                        "",
                        {}});
  add(VagueFixes(gnss));
  add(SplitFixes(gnss));
  add(Contradiction(odometry.cameras));
  add(BlindParts(odometry));
  AddWrongMounts(odometry, rig, findings);
  add(WrongForces(odometry));
  add(WrongForceScale(odometry, rig));
  // By wrong turns cameras seem to be elsewhere, too.
  const std::optional<Finding> turns = WrongTurns(agreement);
  add(turns ? turns : WrongPlace(agreement));
  add(WrongBody(agreement));
  add(ImuDelay(odometry.calibration));
  return findings;
}

}  // namespace parkade

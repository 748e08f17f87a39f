#include "slam/odometry/standstill_detector.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/error.h"
#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr size_t kMinCommonTracks = 8;
constexpr double kKeepMotions = 5.0;  // [s]
constexpr double kMovingFactor = 5;   // images this much livelier than still overrule the wheels
constexpr double kNoiseSigmas = 3;
constexpr double kHysteresis = 1.5;        // of the image motion of a car that stood
constexpr double kImageSigmas = 2.2;       // median of the difference of two bearings at rest: 1.7
constexpr double kMinChangeOfForce = 0.2;  // [m/s^2] engines shake
constexpr double kMostTracks = 0.75;       // the share that has to rest where only images tell
constexpr double kMostSigmas = 3.2;  // that quantile of the difference of two bearings at rest: 2.4

struct MotionOfTracks {
  double median = 0, most = 0, sigma = 0;  // [rad]
};

std::optional<MotionOfTracks> MeasureMotion(const TrackedFrame& from, const TrackedFrame& to) {
  std::unordered_map<std::int64_t, Eigen::Vector3d> before;
  for (const FeatureObservation& seen : from.observations) before.emplace(seen.track, seen.bearing);
  std::vector<double> angles, sigmas;
  for (const FeatureObservation& seen : to.observations) {
    const auto found = before.find(seen.track);
    if (found == before.end()) continue;
    angles.push_back(found->second.cross(seen.bearing).norm());
    sigmas.push_back(seen.sigma);
  }
  if (angles.size() < kMinCommonTracks) return std::nullopt;
  const auto quantile = [](std::vector<double>& values, double share) {
    return NthSmallest(values, static_cast<size_t>(share * static_cast<double>(values.size())));
  };
  return MotionOfTracks{quantile(angles, 0.5), quantile(angles, kMostTracks),
                        quantile(sigmas, 0.5)};
}

/// Root of the summed variances of the three axes.
template <typename Field>
double Deviation(const std::vector<ImuSample>& samples, Field field) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) mean += sample.*field;
  mean /= static_cast<double>(samples.size());
  double sum = 0;
  for (const ImuSample& sample : samples) sum += (sample.*field - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

/// [m/s^2] from the first third of an interval to its last: the spread of a noisy accelerometer
/// hides a gentle start.
double ChangeOfForce(const std::vector<ImuSample>& samples) {
  const size_t third = samples.size() / 3;
  if (third == 0) return 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), last = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < third; ++i) {
    first += samples[i].linear_acceleration;
    last += samples[samples.size() - 1 - i].linear_acceleration;
  }
  return (last - first).norm() / static_cast<double>(third);
}

}  // namespace

void StandstillOptions::Validate() const {
  Require(wheel_speed > 0 && image_motion > 0 && image_interval > 0 && gyroscope_deviation > 0 &&
              accelerometer_deviation > 0,
          ErrorCode::kUsage, "the thresholds of standstill must be positive");
}

StandstillDetector::StandstillDetector(const ImuCalibration& imu, size_t num_cameras,
                                       const StandstillOptions& options)
    : options_(options), recent_(num_cameras), motions_(num_cameras) {
  const double three_axes = kNoiseSigmas * std::sqrt(3 * imu.update_rate);
  max_gyroscope_deviation_ =
      std::max(options.gyroscope_deviation, three_axes * imu.gyroscope_noise_density);
  max_accelerometer_deviation_ =
      std::max(options.accelerometer_deviation, three_axes * imu.accelerometer_noise_density);
  // Noise of the difference between means over a third of the interval each.
  constexpr double kThird = 0.1;  // [s] the estimator looks at intervals three times as long
  max_change_of_force_ = std::max(kMinChangeOfForce, kNoiseSigmas * std::sqrt(2 * 3 / kThird) *
                                                         imu.accelerometer_noise_density);
}

void StandstillDetector::Add(const TrackedFrame& frame) {
  auto& recent = recent_[static_cast<size_t>(frame.camera)];
  auto& motions = motions_[static_cast<size_t>(frame.camera)];
  recent.push_back(frame);
  // Keep one frame that is at least the interval old, to compare with.
  while (recent.size() > 2 && frame.time - recent[1].time >= options_.image_interval)
    recent.pop_front();
  const double age = frame.time - recent.front().time;
  if (age >= options_.image_interval && age < 3 * options_.image_interval)
    if (const std::optional<MotionOfTracks> motion = MeasureMotion(recent.front(), frame))
      motions.push_back({frame.time, motion->median, motion->most, motion->sigma});
  while (!motions.empty() && frame.time - motions.front().time > kKeepMotions) motions.pop_front();
}

StandstillDetector::Images StandstillDetector::ImagesDuring(Timestamp begin, Timestamp end,
                                                            bool is_any_enough,
                                                            double tolerance) const {
  int num_still = 0, num_moving = 0, num_clearly_moving = 0;
  for (const auto& motions : motions_) {
    double worst = -1;  // in units of what is still noise
    for (const ImageMotion& motion : motions)
      // A motion is measured over the interval before its stamp: take those that end inside.
      if (motion.time > begin && motion.time <= end)
        worst = std::max(
            worst,
            is_any_enough
                ? motion.median / std::max(options_.image_motion, kImageSigmas * motion.sigma)
                : motion.most / std::max(options_.image_motion, kMostSigmas * motion.sigma));
    if (worst < 0) continue;
    (worst < tolerance ? num_still : num_moving) += 1;
    if (worst > tolerance * kMovingFactor) ++num_clearly_moving;
  }
  if (num_still + num_moving == 0) return Images::kUnknown;
  if (is_any_enough)
    return num_clearly_moving == num_still + num_moving ? Images::kMoving : Images::kStill;
  return num_moving > 0 ? Images::kMoving : Images::kStill;
}

bool StandstillDetector::IsStill(const ImuBuffer& imu, const WheelBuffer& wheels, Timestamp begin,
                                 Timestamp end, bool was_still) const {
  const std::vector<ImuSample> samples = imu.Between(begin, end);
  const double tolerance = was_still ? kHysteresis : 1;
  if (Deviation(samples, &ImuSample::angular_velocity) > max_gyroscope_deviation_) return false;
  if (wheels.LongestGap(begin, end) < 0.5) {
    for (const WheelSample& sample : wheels.Between(begin, end))
      if (std::abs(sample.forward_speed) > options_.wheel_speed) return false;
    return ImagesDuring(begin, end, /*is_any_enough=*/true, tolerance) != Images::kMoving;
  }
  if (Deviation(samples, &ImuSample::linear_acceleration) > max_accelerometer_deviation_)
    return false;
  if (ChangeOfForce(samples) > max_change_of_force_) return false;
  const Images images = ImagesDuring(begin, end, /*is_any_enough=*/false, tolerance);
  return images == Images::kStill || (images == Images::kUnknown && was_still);
}

}  // namespace parkade

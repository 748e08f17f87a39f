// The scale of a start from the height of the cameras above the ground.
#include <algorithm>
#include <cmath>
#include <set>

#include "slam/initialization/start_problem.h"

namespace parkade {
namespace {

constexpr double kMinHeight = 0.2;       // [m] of a camera above the ground, to be of use
constexpr double kMinDepression = 0.15;  // sine of the angle below the horizon
constexpr double kMinCertainty = 6;      // inverse distance / sigma of a point that counts
constexpr double kBandwidth = 0.05;      // of the logarithm of the scale: verges lie above the road
constexpr double kWidth = 0.15;          // about the peak
constexpr int kMinPoints = 5, kManyPoints = 12;
constexpr double kMinShare = 0.25;      // of the points below the cameras
constexpr double kMinShareOfFew = 0.6;  // of them, while fewer than kManyPoints are of the ground
constexpr double kSigma = 0.04;         // slopes, suspension; plus what each camera adds
constexpr double kSigmaOfCamera = 0.08;

struct Height {
  double log_scale = 0;
  int camera = 0;
};

}  // namespace

std::optional<GroundScale> MeasureGroundScale(const StartProblem& problem, const Rig& rig) {
  if (!rig.vehicle) return std::nullopt;
  const Eigen::Vector3d up_in_imu =
      rig.body_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  std::vector<Height> heights;
  for (const StartTrack& track : problem.tracks) {
    const StartImage& image = problem.images[track.observations.front().image];
    const double height =
        rig.cameras[static_cast<size_t>(image.camera)].body_from_camera.translation.z();
    if (height < kMinHeight ||
        track.inverse_distance < kMinCertainty * track.inverse_distance_sigma)
      continue;
    const double sine = -track.ray.dot(image.rotation * up_in_imu);
    if (sine < kMinDepression) continue;
    heights.push_back({std::log(height * track.inverse_distance / sine), image.camera});
  }
  const auto closeness = [](double log_scale, double peak) {
    return std::exp(-0.5 * std::pow((log_scale - peak) / kBandwidth, 2));
  };
  double highest = 0, peak = 0;
  for (const Height& at : heights) {
    double density = 0;
    for (const Height& other : heights) density += closeness(other.log_scale, at.log_scale);
    if (density > highest) {
      highest = density;
      peak = at.log_scale;
    }
  }
  GroundScale scale;
  std::set<int> cameras;
  for (const Height& at : heights) {
    scale.log_scale += closeness(at.log_scale, peak) * at.log_scale;
    if (std::abs(at.log_scale - peak) > kWidth) continue;
    ++scale.num_points;
    cameras.insert(at.camera);
  }
  const auto below = static_cast<double>(heights.size());
  const double needed =
      std::max(kMinShare * below, std::min<double>(kManyPoints, kMinShareOfFew * below));
  if (scale.num_points < std::max<double>(kMinPoints, needed)) return std::nullopt;
  scale.log_scale /= highest;
  scale.sigma = std::hypot(kSigma, kSigmaOfCamera / std::sqrt(static_cast<double>(cameras.size())));
  return scale;
}

}  // namespace parkade

#include "tests/slam/worlds/place_world.h"

#include <random>

namespace parkade {
namespace {

struct Mount {
  Eigen::Vector3d origin;  ///< [m] in the keyframe
  double azimuth;          ///< [rad]
};
const Mount kMounts[] = {
    {{3.7, 0, 0.6}, 0}, {{2, 1, 1}, M_PI / 2}, {{2, -1, 1}, -M_PI / 2}, {{-0.9, 0, 0.9}, M_PI}};
constexpr double kHalfView = 1.5;  // [rad]

/// The keyframe's features of the points that a camera sees; one row of random bits per point.
RigKeyframe Observe(const std::vector<Eigen::Vector3d>& points, const cv::Mat& descriptors,
                    const Rigid3& keyframe_from_world, const PlaceWorldOptions& options,
                    std::mt19937& random) {
  std::normal_distribution<double> normal;
  RigKeyframe keyframe;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point = keyframe_from_world * points[i];
    for (int camera = 0; camera < 4; ++camera) {
      const Mount& mount = kMounts[camera];
      const Eigen::Vector3d view = point - mount.origin;
      const double off = std::remainder(std::atan2(view.y(), view.x()) - mount.azimuth, 2 * M_PI);
      if (std::abs(off) > kHalfView || view.norm() < 1) continue;
      KeyframeFeature feature;
      feature.camera = camera;
      feature.origin = mount.origin;
      const Eigen::Vector3d noise(normal(random), normal(random), normal(random));
      feature.bearing = (view.normalized() + options.bearing_sigma * noise).normalized();
      feature.sigma = options.bearing_sigma;
      const double distance = view.norm() * (1 + options.depth_error * normal(random));
      feature.point = mount.origin + distance * feature.bearing;
      feature.depth_sigma = options.depth_error * view.norm();
      keyframe.features.push_back(feature);
      keyframe.descriptors.push_back(descriptors.row(static_cast<int>(i)));
      break;
    }
  }
  return keyframe;
}

}  // namespace

PlaceWorld MakePlaceWorld(const PlaceWorldOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector3d> points;
  cv::Mat descriptors(options.num_points, 32, CV_8UC1);
  for (int i = 0; i < options.num_points; ++i) {
    const double angle = M_PI * uniform(random), distance = 14 + 10 * uniform(random);
    points.emplace_back(distance * std::cos(angle), distance * std::sin(angle),
                        1.5 + 1.5 * uniform(random));
    for (int k = 0; k < 32; ++k) descriptors.at<uchar>(i, k) = static_cast<uchar>(random());
  }
  PlaceWorld world;
  world.a = Observe(points, descriptors, {}, options, random);
  cv::Mat seen_in_b = descriptors.clone();
  const int num_wrong = static_cast<int>(options.wrong_share * options.num_points);
  for (int i = 0; i < num_wrong; ++i) descriptors.row((i + 1) % num_wrong).copyTo(seen_in_b.row(i));
  world.b = Observe(points, seen_in_b, options.a_from_b.Inverse(), options, random);
  return world;
}

}  // namespace parkade

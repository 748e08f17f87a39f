#include "slam/baselines/relative_pose_baselines.h"

#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>

#include "core/math/decompositions.h"
#include "slam/places/adjust_to_correspondences.h"
#include "slam/places/adjust_two_views.h"

namespace parkade {
namespace {

constexpr double kMinForward =
    0.3;  // cosine to the mean bearing below which a ray does not fit a plane
// A wrong match passes where it happens to lie on its epipolar line: errors of accepted loops were
// twice as large (squared) as their inliers show.
constexpr double kEpipolarInflation = 2;
constexpr int kMinInliersPnp = 10;
constexpr int kRoundsPnp = 3;  // rounds of choosing inliers and adjusting
constexpr double kRansacProbability = 0.999;

/// The matches of the camera pair that has the most, as far as their rays lie in front of both
/// cameras.
std::vector<FeatureMatch> OfBestCameraPair(const RigKeyframe& a, const RigKeyframe& b,
                                           const std::vector<FeatureMatch>& matches) {
  std::map<std::pair<int, int>, std::vector<FeatureMatch>> by_pair;
  for (const FeatureMatch& match : matches)
    by_pair[{a.features[match.a].camera, b.features[match.b].camera}].push_back(match);
  std::vector<FeatureMatch> best;
  for (auto& [pair, of_pair] : by_pair)
    if (of_pair.size() > best.size()) best = std::move(of_pair);
  return best;
}

/// Rotation whose z axis is the mean of the bearings: a pinhole that sees them all as well as one
/// can.
Eigen::Matrix3d ViewFromPlace(const RigKeyframe& keyframe, const std::vector<size_t>& features) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const size_t i : features) mean += keyframe.features[i].bearing;
  return RotationBetween(mean, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

/// The rays of both keyframes on the image planes of their views.
struct PlanarRays {
  Eigen::Matrix3d view_from_a, view_from_b;
  std::vector<FeatureMatch> matches;
  std::vector<cv::Point2d> in_a, in_b;
  double sigma = 0;  ///< mean of the rays' [rad]
};

PlanarRays Flatten(const RigKeyframe& a, const RigKeyframe& b,
                   const std::vector<FeatureMatch>& matches) {
  PlanarRays rays;
  std::vector<size_t> of_a, of_b;
  for (const FeatureMatch& match : matches) {
    of_a.push_back(match.a);
    of_b.push_back(match.b);
  }
  rays.view_from_a = ViewFromPlace(a, of_a);
  rays.view_from_b = ViewFromPlace(b, of_b);
  for (const FeatureMatch& match : matches) {
    const Eigen::Vector3d first = rays.view_from_a * a.features[match.a].bearing;
    const Eigen::Vector3d second = rays.view_from_b * b.features[match.b].bearing;
    if (first.z() < kMinForward || second.z() < kMinForward) continue;
    rays.matches.push_back(match);
    rays.in_a.emplace_back(first.x() / first.z(), first.y() / first.z());
    rays.in_b.emplace_back(second.x() / second.z(), second.y() / second.z());
    rays.sigma += 0.5 * (a.features[match.a].sigma + b.features[match.b].sigma);
  }
  if (!rays.matches.empty()) rays.sigma /= static_cast<double>(rays.matches.size());
  return rays;
}

Eigen::Matrix3d ToEigen(const cv::Mat& matrix) {
  Eigen::Matrix3d result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) result(row, column) = matrix.at<double>(row, column);
  return result;
}

Eigen::Vector3d ToVector(const cv::Mat& vector) {
  return {vector.at<double>(0), vector.at<double>(1), vector.at<double>(2)};
}

/// The covariance that errors of the two cameras' mounts add to the rotation between them: the same
/// camera errs alike twice, so that nothing is left where the car heads the same way.
Eigen::Matrix3d MountsIn(const Eigen::Quaterniond& a_from_b, bool is_same_camera,
                         const RelativePoseOptions& options) {
  const double variance = std::pow(options.mount_rotation_deg * M_PI / 180, 2);
  if (!is_same_camera) return 2 * variance * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d off = Eigen::Matrix3d::Identity() - a_from_b.toRotationMatrix().transpose();
  return variance * off * off.transpose();
}

bool IsTilted(const Eigen::Quaterniond& a_from_b, const RelativePoseOptions& options) {
  const double tilt = std::acos(std::clamp((a_from_b * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
  return tilt > options.max_tilt_deg * M_PI / 180;
}

/// Adjusts a first pose to the rays of `b` that meet points of `a`, and says how well it is known.
void AdjustPnp(const RigKeyframe& a, const RigKeyframe& b, const std::vector<FeatureMatch>& matches,
               const RelativePoseOptions& options, RelativePose& pose) {
  std::vector<RayPointCorrespondence> correspondences = CorrespondencesOf(a, b, matches), inliers;
  std::erase_if(correspondences, [](const RayPointCorrespondence& correspondence) {
    return correspondence.is_forward;
  });
  Matrix6d hessian = Matrix6d::Identity();
  for (int round = 0; round < kRoundsPnp; ++round) {
    inliers.clear();
    double sum = 0;
    for (const RayPointCorrespondence& correspondence : correspondences) {
      const CorrespondenceError error = ErrorOf(correspondence, pose.a_from_b);
      if (!error.is_in_front || error.whitened.norm() >= options.max_error) continue;
      inliers.push_back(correspondence);
      sum += error.whitened.squaredNorm();
    }
    pose.num_inliers = static_cast<int>(inliers.size());
    if (pose.num_inliers < kMinInliersPnp) return;
    pose.residual = std::sqrt(sum / (2.0 * static_cast<double>(inliers.size())));
    hessian = AdjustToCorrespondences(inliers, /*tilt_sigma=*/0, pose.a_from_b);
  }
  SetInformation(CovarianceOfCorrespondences(inliers, hessian, pose.a_from_b, options), pose);
  pose.rejected.clear();
  if (IsTilted(pose.a_from_b.rotation, options)) pose.rejected = "gravity differs";
  if (!(pose.worst_sigma < options.max_sigma)) pose.rejected = "a direction is not fixed";
}

}  // namespace

RelativePose EstimatePnpPose(const RigKeyframe& a, const RigKeyframe& b,
                             const std::vector<FeatureMatch>& matches,
                             const RelativePoseOptions& options) {
  RelativePose pose;
  pose.num_matches = static_cast<int>(matches.size());
  pose.num_camera_pairs = 1;
  pose.rejected = "too few inliers";
  std::vector<FeatureMatch> with_point;
  std::copy_if(matches.begin(), matches.end(), std::back_inserter(with_point),
               [&](const FeatureMatch& match) { return a.features[match.a].point.has_value(); });
  const PlanarRays rays = Flatten(a, b, OfBestCameraPair(a, b, with_point));
  if (rays.matches.size() < 6) return pose;
  std::vector<cv::Point3d> points;
  for (const FeatureMatch& match : rays.matches) {
    const Eigen::Vector3d& point = *a.features[match.a].point;
    points.emplace_back(point.x(), point.y(), point.z());
  }
  cv::theRNG().state = 1;
  cv::Mat turn, shift, inliers;
  const bool is_solved = cv::solvePnPRansac(points, rays.in_b, cv::Mat::eye(3, 3, CV_64F),
                                            cv::noArray(), turn, shift, false, options.iterations,
                                            static_cast<float>(options.max_error * rays.sigma),
                                            kRansacProbability, inliers, cv::SOLVEPNP_EPNP);
  pose.num_inliers = inliers.rows;
  if (!is_solved || pose.num_inliers < kMinInliersPnp) return pose;
  cv::Mat rotation;
  cv::Rodrigues(turn, rotation);
  // View of b's camera from a, with the camera's center at its origin.
  const Rigid3 view_from_a{Eigen::Quaterniond(ToEigen(rotation)).normalized(), ToVector(shift)};
  const Eigen::Vector3d center_in_b = b.features[rays.matches.front().b].origin;
  const Rigid3 view_from_b{Eigen::Quaterniond(rays.view_from_b), -(rays.view_from_b * center_in_b)};
  pose.a_from_b = view_from_a.Inverse() * view_from_b;
  AdjustPnp(a, b, rays.matches, options, pose);
  return pose;
}

TwoViewPose EstimateTwoViewPose(const RigKeyframe& a, const RigKeyframe& b,
                                const std::vector<FeatureMatch>& matches,
                                const RelativePoseOptions& options) {
  TwoViewPose pose;
  pose.num_matches = static_cast<int>(matches.size());
  pose.rejected = "too few inliers";
  const PlanarRays rays = Flatten(a, b, OfBestCameraPair(a, b, matches));
  if (rays.matches.size() < static_cast<size_t>(options.min_inliers_of_one)) return pose;
  cv::theRNG().state = 1;
  cv::Mat inliers;
  const cv::Mat essential =
      cv::findEssentialMat(rays.in_b, rays.in_a, cv::Mat::eye(3, 3, CV_64F), cv::RANSAC,
                           kRansacProbability, options.max_error * rays.sigma, inliers);
  if (essential.rows != 3) return pose;
  cv::Mat rotation, direction;
  // x_in_view_a = R x_in_view_b + t
  pose.num_inliers = cv::recoverPose(essential, rays.in_b, rays.in_a, cv::Mat::eye(3, 3, CV_64F),
                                     rotation, direction, inliers);
  if (pose.num_inliers < options.min_inliers_of_one) return pose;
  const Eigen::Matrix3d a_from_b =
      rays.view_from_a.transpose() * ToEigen(rotation) * rays.view_from_b;
  pose.first_from_second = {Eigen::Quaterniond(a_from_b).normalized(),
                            rays.view_from_a.transpose() * ToVector(direction).normalized()};
  std::vector<RayPair> pairs;
  for (int i = 0; i < inliers.rows; ++i) {
    const FeatureMatch& match = rays.matches[static_cast<size_t>(i)];
    const KeyframeFeature &in_a = a.features[match.a], &in_b = b.features[match.b];
    if (inliers.at<uchar>(i)) pairs.push_back({in_a.bearing, in_b.bearing, in_a.sigma, in_b.sigma});
  }
  const AdjustedTwoViews adjusted = AdjustTwoViews(pairs, pose.first_from_second);
  const KeyframeFeature &first = a.features[rays.matches.front().a],
                        &second = b.features[rays.matches.front().b];
  pose.first_in_a = first.origin;
  pose.second_in_b = second.origin;
  pose.rotation_covariance =
      adjusted.rotation_covariance +
      MountsIn(pose.first_from_second.rotation, first.camera == second.camera, options);
  pose.direction_sigma = std::hypot(std::sqrt(kEpipolarInflation) * adjusted.direction_sigma,
                                    options.mount_rotation_deg * M_PI / 180);
  pose.rejected = IsTilted(pose.first_from_second.rotation, options) ? "gravity differs" : "";
  return pose;
}

Matrix6d ScaleLessInformation(const Rigid3& from_from_to,
                              const Eigen::Matrix3d& rotation_covariance, double translation_sigma,
                              bool has_direction) {
  Matrix6d information = Matrix6d::Zero();
  const Eigen::Matrix3d rotation = rotation_covariance.inverse();
  information.bottomRightCorner<3, 3>() = 0.5 * (rotation + rotation.transpose());
  if (!has_direction) return information;
  // RelativePoseError has its translation in `to`.
  const Eigen::Vector3d direction =
      from_from_to.rotation.conjugate() * from_from_to.translation.normalized();
  information.topLeftCorner<3, 3>() =
      (Eigen::Matrix3d::Identity() - direction * direction.transpose()) /
      (translation_sigma * translation_sigma);
  return information;
}

}  // namespace parkade

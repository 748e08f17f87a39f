#include "slam/relative_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <map>
#include <opencv2/features2d.hpp>
#include <random>

#include "core/error.h"
#include "slam/guided_matches.h"
#include "slam/sight.h"

namespace parkade {
namespace {

constexpr int kRounds = 3;                            // of choosing inliers and adjusting
constexpr int kSteps = 8;                             // Gauss-Newton steps per round
constexpr double kTiltSigma = 0.3 * M_PI / 180;       // [rad] between the gravity of two places
constexpr double kFloorTranslation = 0.01;            // [m] below which no loop is believed
constexpr double kFloorRotation = 0.05 * M_PI / 180;  // [rad] the same

bool IsInlier(const Sight& sight, const Rigid3& a_from_b, double max_error) {
  const SightError error = ErrorOf(sight, a_from_b);
  return error.is_in_front && error.whitened.norm() < max_error;
}

std::optional<Rigid3> SearchPose(const std::vector<Sight>& sights, const RelativePoseOptions& options) {
  std::vector<size_t> forward, backward;
  for (size_t i = 0; i < sights.size(); ++i) (sights[i].is_forward ? forward : backward).push_back(i);
  std::mt19937 random(1);
  const auto pick = [&random](const std::vector<size_t>& from) { return from[random() % from.size()]; };
  std::optional<Rigid3> best;
  size_t most = 0;
  for (int i = 0; i < options.iterations; ++i) {
    const std::vector<size_t>& from = (i % 2 == 0 && forward.size() > 1) || backward.size() < 2 ? forward : backward;
    if (from.size() < 2) break;
    const size_t first = pick(from), second = pick(from);
    if (first == second) continue;
    for (const Rigid3& pose : SolveUprightPose(sights[first], sights[second])) {
      const auto count = static_cast<size_t>(std::count_if(
          sights.begin(), sights.end(), [&](const Sight& sight) { return IsInlier(sight, pose, options.max_error); }));
      if (count <= most) continue;
      most = count;
      best = pose;
    }
  }
  return best;
}

/// Gauss-Newton with Cauchy weights; the Hessian is that of the last step, gravity included.
Matrix6d Adjust(const std::vector<Sight>& sights, Rigid3& a_from_b) {
  Matrix6d hessian;
  for (int step = 0; step < kSteps; ++step) {
    hessian.setZero();
    Vector6d gradient = Vector6d::Zero();
    for (const Sight& sight : sights) {
      const SightError error = ErrorOf(sight, a_from_b);
      const double weight = 1 / (1 + error.whitened.squaredNorm() / 4);
      hessian += weight * error.jacobian.transpose() * error.jacobian;
      gradient += weight * error.jacobian.transpose() * error.whitened;
    }
    // Both places are level: what tilts one against the other costs.
    const Eigen::Vector3d up_in_b = a_from_b.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d tilt_error = Eigen::Vector3d::UnitZ().cross(up_in_b);
    const Eigen::Matrix3d by_turn = Skew(Eigen::Vector3d::UnitZ()) * Skew(up_in_b);
    hessian.bottomRightCorner<3, 3>() += by_turn.transpose() * by_turn / (kTiltSigma * kTiltSigma);
    gradient.tail<3>() += by_turn.transpose() * tilt_error / (kTiltSigma * kTiltSigma);

    const Vector6d delta = -(hessian + 1e-9 * Matrix6d::Identity()).ldlt().solve(gradient);
    a_from_b.translation += a_from_b.rotation * delta.head<3>();
    a_from_b.rotation = (a_from_b.rotation * ExpSo3(delta.tail<3>())).normalized();
    if (delta.norm() < 1e-7) break;
  }
  return hessian;
}

std::vector<CameraPairInliers> CountByCameras(const std::map<size_t, int>& camera_pair_of_match) {
  std::map<int, int> counts;
  for (const auto& [match, pair] : camera_pair_of_match) ++counts[pair];
  std::vector<CameraPairInliers> by_cameras;
  for (const auto& [pair, count] : counts)
    by_cameras.push_back({pair / kCamerasPerPlace, pair % kCamerasPerPlace, count});
  std::stable_sort(by_cameras.begin(), by_cameras.end(),
                   [](const CameraPairInliers& a, const CameraPairInliers& b) { return a.count > b.count; });
  return by_cameras;
}

/// Chooses inliers and adjusts the pose to them, by turns.
Matrix6d AdjustToInliers(const std::vector<Sight>& sights, const RelativePoseOptions& options, RelativePose& pose) {
  Matrix6d hessian = Matrix6d::Identity();
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Sight> inliers;
    std::map<size_t, int> camera_pair_of_match;
    double sum = 0;
    for (const Sight& sight : sights) {
      if (!IsInlier(sight, pose.a_from_b, options.max_error)) continue;
      inliers.push_back(sight);
      camera_pair_of_match[sight.match] = sight.camera_pair;
      sum += ErrorOf(sight, pose.a_from_b).whitened.squaredNorm();
    }
    pose.num_inliers = static_cast<int>(camera_pair_of_match.size());
    pose.inliers_of_cameras = CountByCameras(camera_pair_of_match);
    pose.num_camera_pairs = static_cast<int>(pose.inliers_of_cameras.size());
    pose.residual = inliers.empty() ? 0 : std::sqrt(sum / (2.0 * static_cast<double>(inliers.size())));
    hessian = Adjust(inliers, pose.a_from_b);
  }
  return hessian;
}

/// Covariance that says what is believed, the floor included, and its inverse.
void SetInformation(const Matrix6d& hessian, RelativePose& pose) {
  Matrix6d covariance = hessian.ldlt().solve(Matrix6d::Identity()) * std::max(1.0, pose.residual * pose.residual);
  // A match may give two sights, and points of one place share the odometry's errors.
  covariance *= 2;
  covariance.diagonal().head<3>().array() += kFloorTranslation * kFloorTranslation;
  covariance.diagonal().tail<3>().array() += kFloorRotation * kFloorRotation;
  const Eigen::Matrix3d translation = covariance.topLeftCorner<3, 3>();
  pose.worst_sigma = std::sqrt(
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(translation, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff());
  pose.information = covariance.ldlt().solve(Matrix6d::Identity());
  pose.information = 0.5 * (pose.information + pose.information.transpose()).eval();
}

std::string ReasonAgainst(const RelativePose& pose, const RelativePoseOptions& options) {
  const int needed = pose.num_camera_pairs > 1 ? options.min_inliers : options.min_inliers_of_one;
  if (pose.num_inliers < needed) return "too few inliers";
  const double tilt = std::acos(std::clamp((pose.a_from_b.rotation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
  if (tilt > options.max_tilt_deg * M_PI / 180) return "gravity differs";
  if (!(pose.worst_sigma < options.max_sigma)) return "a direction is not fixed";
  return "";
}

}  // namespace

void RelativePoseOptions::Validate() const {
  Require(max_hamming > 0 && max_hamming <= 256 && ratio > 0 && ratio <= 1, ErrorCode::kUsage,
          "max_hamming of relative poses must be 1 to 256 and ratio above 0, at most 1");
  Require(iterations > 0 && max_error > 0 && min_guiding_inliers > 2 && max_tilt_deg > 0 && min_inliers > 2 &&
              min_inliers_of_one > 2 && max_sigma > 0,
          ErrorCode::kUsage, "the options of relative poses must be positive, and at least 3 inliers");
}

std::vector<FeatureMatch> MatchPlaces(const Place& a, const Place& b, const RelativePoseOptions& options) {
  if (a.descriptors.rows < 2 || b.descriptors.rows < 2) return {};
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> pairs;
  matcher.knnMatch(a.descriptors, b.descriptors, pairs, 2);
  std::vector<std::optional<cv::DMatch>> best_of_b(b.features.size());
  for (const auto& pair : pairs) {
    if (pair.size() < 2 || pair[0].distance > static_cast<float>(options.max_hamming) ||
        pair[0].distance > options.ratio * pair[1].distance)
      continue;
    std::optional<cv::DMatch>& best = best_of_b[static_cast<size_t>(pair[0].trainIdx)];
    if (!best || pair[0].distance < best->distance) best = pair[0];
  }
  std::vector<FeatureMatch> matches;
  for (const auto& best : best_of_b)
    if (best) matches.push_back({static_cast<size_t>(best->queryIdx), static_cast<size_t>(best->trainIdx)});
  return matches;
}

RelativePose EstimateRigPose(const Place& a, const Place& b, const std::vector<FeatureMatch>& matches,
                             const RelativePoseOptions& options) {
  RelativePose pose;
  pose.num_matches = static_cast<int>(matches.size());
  const std::vector<Sight> sights = SightsOf(a, b, matches);
  const std::optional<Rigid3> found = SearchPose(sights, options);
  if (!found) {
    pose.rejected = "too few inliers";
    return pose;
  }
  pose.a_from_b = *found;
  Matrix6d hessian = AdjustToInliers(sights, options, pose);
  pose.num_first_inliers = pose.num_inliers;
  if (pose.num_inliers >= options.min_guiding_inliers) {
    const std::vector<FeatureMatch> guided = FindGuidedMatches(a, b, pose.a_from_b, options);
    hessian = AdjustToInliers(SightsOf(a, b, guided), options, pose);
  }
  SetInformation(hessian, pose);
  pose.rejected = ReasonAgainst(pose, options);
  return pose;
}

}  // namespace parkade

#include "mapping/observation/estimate_ground_plane.h"

#include <pcl/ModelCoefficients.h>
#include <pcl/PointIndices.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/method_types.h>
#include <pcl/sample_consensus/model_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <limits>
#include <numbers>

namespace parkade {
namespace {

constexpr double kMaxLandmarkSigma = 0.3;  // [m] less certain landmarks are not used
constexpr double kMaxDistance = 8.0;       // [m] of a landmark to the path, horizontally
constexpr double kInlierDistance = 0.08;   // [m] to the plane
constexpr double kMaxTiltDeg = 10;         // of the plane against gravity
constexpr int kMinInliers = 40;            // fewer landmarks on one plane are no ground
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr double kPoseSpacing = 0.3;  // [m] between the poses that landmarks are seen from
constexpr double kSeenFrom =
    3.0;  // [m] before and after the nearest pose a landmark is seen from too
constexpr double kMinCameraHeight = 0.2;  // [m] of the cameras above the road
constexpr double kMaxShareBelow =
    0.1;  // of the landmarks may lie under the road: reflections, outliers

/// Body poses about kPoseSpacing apart.
std::vector<Rigid3> SpacedPoses(const Trajectory& odom_from_body) {
  std::vector<Rigid3> poses;
  for (const TrajectoryState& state : odom_from_body.states())
    if (poses.empty() ||
        (state.world_from_body.translation - poses.back().translation).norm() > kPoseSpacing)
      poses.push_back(state.world_from_body);
  return poses;
}

/// Mean direction against gravity, in body.
Eigen::Vector3d MeanUpInBody(const std::vector<Rigid3>& odom_from_body) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : odom_from_body)
    sum += pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  return sum.normalized();
}

/// Index of the pose that is nearest horizontally.
std::ptrdiff_t FindNearest(const std::vector<Rigid3>& poses, const Eigen::Vector3d& point_in_odom) {
  const auto distance = [&](const Rigid3& pose) {
    return (pose.translation - point_in_odom).head<2>().squaredNorm();
  };
  return std::min_element(
             poses.begin(), poses.end(),
             [&](const Rigid3& a, const Rigid3& b) { return distance(a) < distance(b); }) -
         poses.begin();
}

/// Landmarks below the lowest camera, each in the body frames of a few poses nearby.
Cloud::Ptr CollectLandmarks(const Rig& rig, const std::vector<Rigid3>& poses,
                            const Eigen::Vector3d& up_in_body,
                            std::span<const Landmark> landmarks) {
  double lowest_camera = std::numeric_limits<double>::max();
  for (const RigCamera& camera : rig.cameras)
    lowest_camera = std::min(lowest_camera, up_in_body.dot(camera.body_from_camera.translation));
  double travel = 0;
  for (size_t i = 1; i < poses.size(); ++i)
    travel += (poses[i].translation - poses[i - 1].translation).norm();
  const double spacing = travel / std::max(1.0, static_cast<double>(poses.size() - 1));
  const std::ptrdiff_t apart =
      std::max<std::ptrdiff_t>(1, std::lround(kSeenFrom / std::max(spacing, kPoseSpacing)));

  Cloud::Ptr cloud(new Cloud);
  for (const Landmark& landmark : landmarks) {
    if (!(landmark.sigma <= kMaxLandmarkSigma)) continue;
    // From the nearest pose alone every landmark lies right beside the body, and pitch would be
    // anyone's guess.
    const std::ptrdiff_t nearest = FindNearest(poses, landmark.point_in_odom);
    for (const std::ptrdiff_t i : {nearest - apart, nearest, nearest + apart}) {
      if (i < 0 || i >= std::ssize(poses)) continue;
      const Eigen::Vector3d point_in_body =
          poses[static_cast<size_t>(i)].Inverse() * landmark.point_in_odom;
      const double height = up_in_body.dot(point_in_body);
      if (height > lowest_camera - kMinCameraHeight) continue;
      if ((point_in_body - height * up_in_body).norm() > kMaxDistance) continue;
      const Eigen::Vector3f point = point_in_body.cast<float>();
      cloud->push_back({point.x(), point.y(), point.z()});
    }
  }
  return cloud;
}

Cloud::Ptr RemoveOutliers(const Cloud::Ptr& cloud) {
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setMeanK(12);
  filter.setStddevMulThresh(2.0);
  Cloud::Ptr kept(new Cloud);
  filter.filter(*kept);
  return kept;
}

/// (unit normal that points up, offset) with normal . p + offset = 0.
std::optional<Eigen::Vector4d> FitPlane(const Cloud::Ptr& cloud,
                                        const Eigen::Vector3d& up_in_body) {
  pcl::SACSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setModelType(pcl::SACMODEL_PERPENDICULAR_PLANE);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setAxis(up_in_body.cast<float>());
  segmentation.setEpsAngle(kMaxTiltDeg * std::numbers::pi / 180);
  segmentation.setDistanceThreshold(kInlierDistance);
  segmentation.setMaxIterations(500);
  segmentation.setOptimizeCoefficients(true);
  segmentation.setInputCloud(cloud);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients coefficients;
  segmentation.segment(inliers, coefficients);
  if (coefficients.values.size() != 4 || inliers.indices.size() < kMinInliers) return std::nullopt;
  Eigen::Vector4d plane(coefficients.values[0], coefficients.values[1], coefficients.values[2],
                        coefficients.values[3]);
  plane /= plane.head<3>().norm();
  if (plane.head<3>().dot(up_in_body) < 0) plane = -plane;
  const auto is_below = [&](const pcl::PointXYZ& point) {
    return plane.head<3>().dot(Eigen::Vector3d(point.x, point.y, point.z)) + plane[3] <
           -3 * kInlierDistance;
  };
  const auto num_below = static_cast<double>(std::count_if(cloud->begin(), cloud->end(), is_below));
  if (num_below > kMaxShareBelow * static_cast<double>(cloud->size())) return std::nullopt;
  return plane;
}

/// Unit vector in the plane of `normal`: where the body travels, else where the first camera looks.
Eigen::Vector3d ForwardInBody(const Rig& rig, const std::vector<Rigid3>& poses,
                              const Eigen::Vector3d& normal) {
  Eigen::Vector3d forward = Eigen::Vector3d::Zero();
  for (size_t i = 1; i < poses.size(); ++i)
    forward +=
        poses[i - 1].rotation.conjugate() * (poses[i].translation - poses[i - 1].translation);
  forward -= normal * normal.dot(forward);
  if (forward.norm() < 1.0)
    forward = rig.cameras.front().body_from_camera.rotation * Eigen::Vector3d::UnitZ();
  forward -= normal * normal.dot(forward);
  return forward.norm() > 1e-3 ? forward.normalized() : normal.unitOrthogonal();
}

}  // namespace

std::optional<Rigid3> EstimateBodyFromGround(const Rig& rig, const Trajectory& odom_from_body,
                                             std::span<const Landmark> landmarks) {
  if (rig.vehicle) return Rigid3{};
  const std::vector<Rigid3> poses = SpacedPoses(odom_from_body);
  if (poses.empty()) return std::nullopt;
  const Eigen::Vector3d up_in_body = MeanUpInBody(poses);
  const Cloud::Ptr cloud = CollectLandmarks(rig, poses, up_in_body, landmarks);
  if (cloud->size() < kMinInliers) return std::nullopt;
  const std::optional<Eigen::Vector4d> plane = FitPlane(RemoveOutliers(cloud), up_in_body);
  if (!plane) return std::nullopt;

  Eigen::Matrix3d axes;
  axes.col(2) = plane->head<3>();
  axes.col(0) = ForwardInBody(rig, poses, axes.col(2));
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Rigid3{Eigen::Quaterniond(axes), -(*plane)[3] * plane->head<3>()};
}

}  // namespace parkade

#include "slam/initialization/gyroscope_bias.h"

#include <Eigen/Eigenvalues>
#include <unordered_map>

#include "core/math/decompositions.h"
#include "slam/factors/imu_preintegration.h"
#include "slam/factors/landmark_parameters.h"

namespace parkade {
namespace {

constexpr double kPairInterval = 0.2;     // [s] between the images of a pair
constexpr double kMaxPairInterval = 0.6;  // [s]
constexpr size_t kMinCommonTracks = 12;
constexpr int kMaxIterations = 12;
constexpr double kPriorSigma = 0.2;  // [rad/s] of any bias
constexpr double kRobustWidth = 3;   // [sigma] Cauchy

struct Pair {
  Eigen::Matrix3d imu_from_camera;
  ImuPreintegration imu;
  std::vector<Eigen::Vector3d> first, second;  // bearings of common tracks
  double sigma = 1e-3;                         // [rad] mean of the bearings
};

std::vector<Pair> MakePairs(const std::vector<TrackedFrame>& frames, const ImuBuffer& imu,
                            const Rig& rig) {
  std::vector<Pair> pairs;
  std::vector<const TrackedFrame*> last(rig.cameras.size(), nullptr);
  for (const TrackedFrame& frame : frames) {
    const TrackedFrame*& before = last[static_cast<size_t>(frame.camera)];
    if (!before || frame.time - before->time > kMaxPairInterval) {
      before = &frame;
      continue;
    }
    if (frame.time - before->time < kPairInterval) continue;
    Pair pair{rig.ImuFromCamera(static_cast<size_t>(frame.camera)).rotation.toRotationMatrix(),
              ImuPreintegration(imu.Between(before->time, frame.time), {}, rig.imu),
              {},
              {},
              0};
    std::unordered_map<std::int64_t, const FeatureObservation*> seen_before;
    for (const FeatureObservation& seen : before->observations)
      seen_before.emplace(seen.track, &seen);
    for (const FeatureObservation& seen : frame.observations) {
      const auto found = seen_before.find(seen.track);
      if (found == seen_before.end()) continue;
      pair.first.push_back(found->second->bearing);
      pair.second.push_back(seen.bearing);
      pair.sigma += seen.sigma;
    }
    before = &frame;
    if (pair.first.size() < kMinCommonTracks) continue;
    pair.sigma *= std::sqrt(2.0) / static_cast<double>(pair.first.size());
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

struct NormalEquations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

// One pair's share, its direction of translation eliminated.
void Accumulate(const Pair& pair, const Eigen::Vector3d& bias, NormalEquations& equations) {
  const MotionIncrement increment = pair.imu.Corrected({bias, Eigen::Vector3d::Zero()});
  const Eigen::Matrix3d first_from_imu =
      pair.imu_from_camera.transpose() * increment.rotation.toRotationMatrix();
  const Eigen::Matrix3d d_rotation = pair.imu.d_gyroscope().topRows<3>();
  std::vector<Eigen::Vector3d> normals;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::vector<double> weights(pair.first.size(), 1);
  for (int pass = 0; pass < 2; ++pass) {  // the second without outliers
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (size_t k = 0; k < pair.first.size(); ++k) {
      if (pass == 0)
        normals.push_back(
            pair.first[k].cross(first_from_imu * (pair.imu_from_camera * pair.second[k])));
      moment += weights[k] * normals[k] * normals[k].transpose();
    }
    translation = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment).eigenvectors().col(0);
    for (size_t k = 0; k < normals.size(); ++k)
      weights[k] = 1 / (1 + std::pow(normals[k].dot(translation) / (kRobustWidth * pair.sigma), 2));
  }
  const Eigen::Matrix<double, 3, 2> across = BasisAcross(translation);
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> gradient = Eigen::Matrix<double, 5, 1>::Zero();
  for (size_t k = 0; k < normals.size(); ++k) {
    const Eigen::Matrix3d d_normal = -Skew(pair.first[k]) * first_from_imu *
                                     Skew(pair.imu_from_camera * pair.second[k]) * d_rotation;
    Eigen::Matrix<double, 5, 1> jacobian;
    jacobian << d_normal.transpose() * translation, across.transpose() * normals[k];
    const double weight = weights[k] / (pair.sigma * pair.sigma);
    information += weight * jacobian * jacobian.transpose();
    gradient += weight * jacobian * normals[k].dot(translation);
  }
  information.bottomRightCorner<2, 2>() += 1e-6 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 3, 2> gain =
      information.topRightCorner<3, 2>() * information.bottomRightCorner<2, 2>().inverse();
  equations.information +=
      information.topLeftCorner<3, 3>() - gain * information.bottomLeftCorner<2, 3>();
  equations.gradient += gradient.head<3>() - gain * gradient.tail<2>();
}

}  // namespace

std::optional<GyroscopeBiasEstimate> EstimateGyroscopeBias(const std::vector<TrackedFrame>& frames,
                                                           const ImuBuffer& imu, const Rig& rig) {
  const std::vector<Pair> pairs = MakePairs(frames, imu, rig);
  if (pairs.empty()) return std::nullopt;
  GyroscopeBiasEstimate estimate;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    NormalEquations equations;
    equations.information = Eigen::Matrix3d::Identity() / (kPriorSigma * kPriorSigma);
    equations.gradient = estimate.bias / (kPriorSigma * kPriorSigma);
    for (const Pair& pair : pairs) Accumulate(pair, estimate.bias, equations);
    const Eigen::Vector3d step = SolveSymmetric(equations.information, equations.gradient);
    if (!step.allFinite()) return std::nullopt;
    estimate.bias -= step;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(equations.information);
    estimate.sigma = 1 / std::sqrt(eigen.eigenvalues()[0]);
    if (step.norm() < 1e-6) break;
  }
  if (estimate.bias.norm() > 3 * kPriorSigma) return std::nullopt;
  return estimate;
}

}  // namespace parkade

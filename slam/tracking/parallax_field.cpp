#include "slam/tracking/parallax_field.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

namespace parkade {
namespace {

constexpr size_t kNeighbors = 8;
constexpr size_t kMinSamples = 6;
constexpr double kSlopeRidge =
    1e-3;  ///< [rad^2] neighbors nearer than this together do not fix a slope

}  // namespace

double ParallaxOf(const Eigen::Vector3d& turned, const Eigen::Vector3d& now,
                  const Eigen::Vector3d& direction) {
  // now x (turned + w direction) = 0, least squares in w.
  const Eigen::Vector3d across = now.cross(direction);
  const double squared = across.squaredNorm();
  if (squared < 1e-6) return 0;
  return std::max(0.0, -now.cross(turned).dot(across) / squared);
}

std::optional<double> ParallaxField::At(const Eigen::Vector3d& bearing) const {
  if (samples_.size() < kMinSamples) return std::nullopt;
  std::vector<std::pair<double, size_t>> nearest(samples_.size());
  for (size_t i = 0; i < samples_.size(); ++i)
    nearest[i] = {(samples_[i].bearing - bearing).squaredNorm(), i};
  const size_t count = std::min(kNeighbors, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count),
                    nearest.end());

  // Value at the bearing and slope around it; the ridge holds the slope down.
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  normal.bottomRightCorner<3, 3>().diagonal().setConstant(kSlopeRidge);
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double largest = 0;
  const double scale = nearest[count / 2].first + 1e-6;
  for (size_t i = 0; i < count; ++i) {
    const Sample& sample = samples_[nearest[i].second];
    const double weight = 1 / (1 + nearest[i].first / scale);
    Eigen::Vector4d row;
    row << 1, sample.bearing - bearing;
    normal += weight * row * row.transpose();
    right += weight * sample.parallax * row;
    largest = std::max(largest, sample.parallax);
  }
  return std::clamp(normal.ldlt().solve(right)[0], 0.0, 2 * largest);
}

}  // namespace parkade

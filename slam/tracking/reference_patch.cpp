#include "slam/tracking/reference_patch.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "slam/tracking/patch_sampling.h"

namespace parkade {
namespace {

constexpr int kMaxIterations = 12;
constexpr double kConvergence = 0.01;  ///< [px] at the patch's center and at its corners
constexpr float kMinContrast = 3;      ///< [gray levels] standard deviation
constexpr double kAffineRidge =
    0.02;  ///< share of the mean curvature that holds the affine part where it is

}  // namespace

bool ReferencePatch::Normalize(Samples& samples, float* norm) {
  samples.array() -= samples.mean();
  *norm = samples.norm();
  if (*norm < kMinContrast * kEdge) return false;
  samples /= *norm;
  return true;
}

std::unique_ptr<const ReferencePatch> ReferencePatch::Take(const cv::Mat& image,
                                                           const Eigen::Vector2d& pixel) {
  Eigen::Matrix<float, kEdge + 2, kEdge + 2> raw;
  if (!SampleGrid<kEdge + 2>(image, pixel, Eigen::Matrix2d::Identity(), raw)) return nullptr;
  const Eigen::Matrix<float, kEdge, kEdge> inner = raw.block<kEdge, kEdge>(1, 1);
  ReferencePatch patch;
  patch.values_ = Eigen::Map<const Samples>(inner.data());
  float norm = 0;
  if (!Normalize(patch.values_, &norm)) return nullptr;

  Eigen::Index index = 0;
  for (int column = 0; column < kEdge; ++column) {
    for (int row = 0; row < kEdge; ++row, ++index) {
      const float dx = 0.5f * (raw(row + 1, column + 2) - raw(row + 1, column)) / norm;
      const float dy = 0.5f * (raw(row + 2, column + 1) - raw(row, column + 1)) / norm;
      const float x = static_cast<float>(column) - 0.5f * (kEdge - 1),
                  y = static_cast<float>(row) - 0.5f * (kEdge - 1);
      patch.jacobian_.row(index) << dx, dy, dx * x, dy * x, dx * y, dy * y;
    }
  }
  for (Eigen::Index i = 0; i < 6; ++i) {
    // Normalizing takes away what a gradient has in common with mean and gain.
    Samples gradient = patch.jacobian_.col(i);
    gradient.array() -= gradient.mean();
    patch.jacobian_.col(i) = gradient - patch.values_ * patch.values_.dot(gradient);
  }
  Eigen::Matrix<double, 6, 6> hessian =
      patch.jacobian_.transpose().lazyProduct(patch.jacobian_).cast<double>();
  hessian.bottomRightCorner<4, 4>().diagonal().array() +=
      kAffineRidge * hessian.diagonal().tail<4>().mean();
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(hessian);
  if (factor.info() != Eigen::Success || factor.rcond() < 1e-7) return nullptr;
  patch.inverse_hessian_ = factor.solve(Eigen::Matrix<double, 6, 6>::Identity());
  return std::make_unique<const ReferencePatch>(patch);
}

std::optional<ReferencePatch::Alignment> ReferencePatch::AlignIn(
    const cv::Mat& image, const Eigen::Vector2d& pixel,
    const Eigen::Matrix2d& image_from_reference) const {
  Alignment alignment{pixel, image_from_reference, 0};
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Eigen::Matrix<float, kEdge, kEdge> raw;
    if (!SampleGrid<kEdge>(image, alignment.pixel, alignment.image_from_reference, raw))
      return std::nullopt;
    Samples seen = Eigen::Map<const Samples>(raw.data());
    float norm = 0;
    if (!Normalize(seen, &norm)) return std::nullopt;
    alignment.correlation = seen.dot(values_);
    const Parameters step =
        inverse_hessian_ * (jacobian_.transpose() * (seen - values_)).cast<double>();
    const Eigen::Matrix2d increment =
        Eigen::Matrix2d::Identity() + Eigen::Map<const Eigen::Matrix2d>(step.data() + 2);
    if (!(increment.determinant() > 0.3)) return std::nullopt;
    // The warp is followed by the inverse of what the template would have to do.
    alignment.image_from_reference *= increment.inverse();
    alignment.pixel -= alignment.image_from_reference * step.head<2>();
    if (step.head<2>().norm() < kConvergence &&
        0.5 * kEdge * step.tail<4>().norm() < 5 * kConvergence)
      return alignment;
  }
  return std::nullopt;
}

}  // namespace parkade

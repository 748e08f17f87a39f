#include "slam/tracking/patch_alignment.h"

#include <Eigen/LU>
#include <cmath>

#include "slam/tracking/patch_sampling.h"

namespace parkade {
namespace {

constexpr int kMaxIterations = 15;
constexpr double kConvergence = 0.01;   ///< [px]
constexpr float kMinContrast = 3;       ///< [gray levels] standard deviation of a patch
constexpr double kMinCurvature = 0.02;  ///< smaller eigenvalue of the normalized Hessian [1/px^2]

using Grid = Eigen::Matrix<float, kPatchEdge + 2, kPatchEdge + 2>;

using Samples = Eigen::Matrix<float, kPatchEdge, kPatchEdge>;

/// Norm of the samples after their mean is gone; they are divided by it.
float Normalize(Patch& patch) {
  patch.array() -= patch.mean();
  const float norm = patch.norm();
  if (norm > 0) patch /= norm;
  return norm;
}

Patch Flatten(const Samples& samples) { return Eigen::Map<const Patch>(samples.data()); }

}  // namespace

std::optional<Patch> SamplePatch(const cv::Mat& image, const Eigen::Vector2d& center,
                                 const Eigen::Matrix2d& image_from_grid) {
  Samples samples;
  if (!SampleGrid<kPatchEdge>(image, center, image_from_grid, samples)) return std::nullopt;
  Patch patch = Flatten(samples);
  if (Normalize(patch) < kMinContrast * kPatchEdge) return std::nullopt;
  return patch;
}

std::optional<PatchTemplate> MakeTemplate(const cv::Mat& image, const Eigen::Vector2d& center,
                                          const Eigen::Matrix2d& image_from_grid) {
  Grid samples;
  if (!SampleGrid<kPatchEdge + 2>(image, center, image_from_grid, samples)) return std::nullopt;
  PatchTemplate patch;
  patch.values = Flatten(samples.block<kPatchEdge, kPatchEdge>(1, 1));
  const float norm = Normalize(patch.values);
  if (norm < kMinContrast * kPatchEdge) return std::nullopt;
  patch.jacobian.col(0) = Flatten(0.5f * (samples.block<kPatchEdge, kPatchEdge>(1, 2) -
                                          samples.block<kPatchEdge, kPatchEdge>(1, 0)));
  patch.jacobian.col(1) = Flatten(0.5f * (samples.block<kPatchEdge, kPatchEdge>(2, 1) -
                                          samples.block<kPatchEdge, kPatchEdge>(0, 1)));
  for (int axis = 0; axis < 2; ++axis) {
    // Normalizing takes away what a gradient has in common with mean and gain.
    Patch gradient = patch.jacobian.col(axis) / norm;
    gradient.array() -= gradient.mean();
    patch.jacobian.col(axis) = gradient - patch.values * patch.values.dot(gradient);
  }
  const Eigen::Matrix2d hessian =
      patch.jacobian.transpose().lazyProduct(patch.jacobian).cast<double>();
  const double half_trace = 0.5 * hessian.trace();
  const double smaller =
      half_trace - std::sqrt(std::max(0.0, half_trace * half_trace - hessian.determinant()));
  if (smaller < kMinCurvature) return std::nullopt;
  patch.inverse_hessian = hessian.inverse();
  return patch;
}

std::optional<PatchMatch> AlignPatch(const PatchTemplate& patch, const cv::Mat& image,
                                     const Eigen::Vector2d& start, double max_shift) {
  PatchMatch match{start, 0};
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const std::optional<Patch> seen = SamplePatch(image, match.pixel, Eigen::Matrix2d::Identity());
    if (!seen) return std::nullopt;
    match.correlation = Correlation(patch.values, *seen);
    const Eigen::Vector2d step =
        -patch.inverse_hessian *
        (patch.jacobian.transpose() * (*seen - patch.values)).cast<double>();
    match.pixel += step;
    if (!((match.pixel - start).norm() <= max_shift)) return std::nullopt;
    if (step.norm() < kConvergence) return match;
  }
  return std::nullopt;
}

}  // namespace parkade

#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace parkade {

/// Samples of a patch, mean 0 and norm 1: what brightness and gain do not change.
inline constexpr int kPatchEdge = 11;
using Patch = Eigen::Matrix<float, kPatchEdge * kPatchEdge, 1>;

/// Normalized correlation in [-1, 1].
inline double Correlation(const Patch& a, const Patch& b) { return a.dot(b); }

/// A patch with what is needed to find it in another image.
struct PatchTemplate {
  Patch values;
  Eigen::Matrix<float, kPatchEdge * kPatchEdge, 2>
      jacobian;  ///< of `values` by the offset in the other image
  Eigen::Matrix2d inverse_hessian;
};

/// Bilinear samples on a grid around `center` [px], one step of the grid being a
/// column of `image_from_grid` [px]. Nothing where the grid leaves the image
/// (CV_8UC1) or holds no contrast.
std::optional<Patch> SamplePatch(const cv::Mat& image, const Eigen::Vector2d& center,
                                 const Eigen::Matrix2d& image_from_grid);

/// The same with derivatives. Nothing where the patch cannot fix both coordinates.
std::optional<PatchTemplate> MakeTemplate(const cv::Mat& image, const Eigen::Vector2d& center,
                                          const Eigen::Matrix2d& image_from_grid);

struct PatchMatch {
  Eigen::Vector2d pixel;  ///< [px] of the center
  double correlation = 0;
};

/// Moves the template over `image` from `start` to the best normalized
/// correlation nearby: inverse compositional Gauss-Newton (S. Baker, I. Matthews,
/// "Lucas-Kanade 20 years on", IJCV 2004) over translation. Nothing when it
/// leaves the image, moves more than `max_shift` [px], or does not converge.
std::optional<PatchMatch> AlignPatch(const PatchTemplate& patch, const cv::Mat& image,
                                     const Eigen::Vector2d& start, double max_shift);

}  // namespace parkade

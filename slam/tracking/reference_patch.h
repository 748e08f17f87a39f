#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace parkade {

/// How a point looked when its track began. Following a track from image to image lets it creep,
/// because perspective changes within the window; aligning every image with the reference patch,
/// under an affine warp, does not.
///
/// J. Shi, C. Tomasi, "Good features to track", CVPR 1994, section 4 (affine
/// consistency with the first image), by inverse compositional Gauss-Newton
/// (S. Baker, I. Matthews, IJCV 2004), brightness and gain removed.
class ReferencePatch {
 public:
  static constexpr int kEdge = 13;  ///< [px]

  /// Null where the patch leaves the image (CV_8UC1) or has too little structure.
  static std::unique_ptr<const ReferencePatch> Take(const cv::Mat& image,
                                                    const Eigen::Vector2d& pixel);

  struct Alignment {
    Eigen::Vector2d pixel;                 ///< [px]
    Eigen::Matrix2d image_from_reference;  ///< affine part of the warp
    double correlation = 0;                ///< normalized, in [-1, 1]
  };

  /// The patch in another image, from a start of about a pixel. Nothing where it
  /// leaves the image or does not converge.
  std::optional<Alignment> AlignIn(const cv::Mat& image, const Eigen::Vector2d& pixel,
                                   const Eigen::Matrix2d& image_from_reference) const;

 private:
  using Samples = Eigen::Matrix<float, kEdge * kEdge, 1>;
  using Parameters = Eigen::Matrix<double, 6, 1>;  ///< shift (2), then the affine part minus
                                                   ///< identity, column by column

  static bool Normalize(Samples& samples, float* norm);

  Samples values_;  ///< mean 0, norm 1
  Eigen::Matrix<float, kEdge * kEdge, 6> jacobian_;
  Eigen::Matrix<double, 6, 6> inverse_hessian_;
};

}  // namespace parkade

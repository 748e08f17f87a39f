#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mapping/texture/exposure_and_vignetting.h"

namespace parkade {

/// How an image shows a place.
struct LightObservation {
  std::uint32_t image = 0;
  float weight = 0;                                   ///< steepness; 0: no observation
  float squared_radius = 0;                           ///< of the pixel, see ExposureAndVignetting
  Eigen::Array3f log_color = Eigen::Array3f::Zero();  ///< of blue, green, red
};

/// The steepest observations of a place.
class LightPlace {
 public:
  static constexpr std::size_t kNumObservations = 8;
  void Add(const LightObservation& observation);
  const std::array<LightObservation, kNumObservations>& observations() const {
    return observations_;
  }

 private:
  std::array<LightObservation, kNumObservations> observations_;  // those without weight last
};

/// An image, before its light is known.
struct LightPrior {
  std::uint32_t lens = 0;                            ///< images of a lens share a falloff
  Eigen::Array3f log_gain = Eigen::Array3f::Zero();  ///< what it has where little is known
};

struct PhotometricCalibration {
  std::vector<Eigen::Array3f> gains;                     ///< per image
  std::vector<ExposureAndVignetting::Falloff> falloffs;  ///< per lens
};

/// Gains of images and falloffs of lenses with which all images show a place alike: least squares
/// of log-colors over the places that several show, the places' own colors eliminated (Brown and
/// Lowe, "Automatic Panoramic Image Stitching using Invariant Features", IJCV 2007, section 6,
/// extended by falloff as Goldman, "Vignette and Exposure Calibration and Compensation", PAMI
/// 2010), reweighted so that what moves or shines counts little. What no place tells stays at the
/// priors. The size of `falloffs` is the largest lens and one.
PhotometricCalibration CalibratePhotometry(const std::vector<LightPrior>& images,
                                           const std::vector<LightPlace>& places);

/// Weighted root mean square by which observations of a place differ from their mean, in mean
/// log-color; 0 without any.
double LightDisagreement(const std::vector<LightPrior>& images,
                         const std::vector<LightPlace>& places,
                         const PhotometricCalibration& light);

}  // namespace parkade

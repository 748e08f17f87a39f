#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mapping/texture/photo_light.h"

namespace parkade {

/// How a photo shows a place.
struct LightSight {
  std::uint32_t photo = 0;
  float weight = 0;                                   ///< steepness; 0: no sight
  float squared_radius = 0;                           ///< of the pixel, see PhotoLight
  Eigen::Array3f log_color = Eigen::Array3f::Zero();  ///< of blue, green, red
};

/// The steepest sights of a place.
class LightPlace {
 public:
  static constexpr std::size_t kNumSights = 8;
  void Add(const LightSight& sight);
  const std::array<LightSight, kNumSights>& sights() const { return sights_; }

 private:
  std::array<LightSight, kNumSights> sights_;  // those without weight last
};

/// A photo, before its light is known.
struct LightPrior {
  std::uint32_t lens = 0;                            ///< photos of a lens share a falloff
  Eigen::Array3f log_gain = Eigen::Array3f::Zero();  ///< what it has where little is known
};

struct BalancedLight {
  std::vector<Eigen::Array3f> gains;          ///< per photo
  std::vector<PhotoLight::Falloff> falloffs;  ///< per lens
};

/// Gains of photos and falloffs of lenses with which all photos show a place alike: least squares of log-colours over
/// the places that several show, the places' own colours eliminated (Brown and Lowe, "Automatic Panoramic Image
/// Stitching using Invariant Features", IJCV 2007, section 6, extended by falloff as Goldman, "Vignette and Exposure
/// Calibration and Compensation", PAMI 2010), reweighted so that what moves or shines counts little. What no place
/// tells stays at the priors. The size of `falloffs` is the largest lens and one.
BalancedLight BalanceLight(const std::vector<LightPrior>& photos, const std::vector<LightPlace>& places);

/// Weighted root mean square by which sights of a place differ from their mean, in mean log-colour; 0 without any.
double LightDisagreement(const std::vector<LightPrior>& photos, const std::vector<LightPlace>& places,
                         const BalancedLight& light);

}  // namespace parkade

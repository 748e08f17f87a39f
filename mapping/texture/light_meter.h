#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "mapping/texture/calibrate_photometry.h"
#include "mapping/texture/chart_painter.h"

namespace parkade {

/// Looks at the same places in many images, from which CalibratePhotometry finds their gains and
/// falloffs.
class LightMeter {
 public:
  /// \param places  [m] in site, on the ground, evenly spread; observations beyond `max_range` [m]
  /// do not count
  LightMeter(std::vector<Eigen::Vector3d> places, std::size_t num_images, double max_range);

  /// In parallel over images; the sums do not depend on the order. `cells` give what an image's
  /// gain is where no other image tells (FindGain).
  void Measure(std::span<const GroundImage> images, const CellFinder& cells);

  /// Sets each image's light, by its index, and where the sun stands in its drive. Logs how much
  /// observations of a place differ without it and with it.
  void Balance(std::span<GroundImage* const> images) const;

 private:
  /// A place beside the car that took an image, where its own shadow may lie.
  struct NearPlace {
    std::size_t place = 0;
    std::uint32_t image = 0;
    float log_color = 0;  ///< mean of blue, green and red
  };

  std::vector<std::pair<std::size_t, LightObservation>> ObservationsOf(
      const GroundImage& image) const;
  void FindSuns(std::span<GroundImage* const> images, const PhotometricCalibration& light) const;

  std::vector<Eigen::Vector3d> points_;  // by x
  std::vector<LightPlace> places_;
  std::vector<NearPlace> near_;
  std::vector<LightPrior> images_;
  double max_range_;
};

}  // namespace parkade

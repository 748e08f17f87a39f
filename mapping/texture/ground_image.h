#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "core/rig.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/ground/wheelbase_footprint.h"
#include "mapping/surface/visibility_horizon.h"
#include "mapping/texture/exposure_and_vignetting.h"

namespace parkade {

/// One image of the ground, and from where it was taken.
struct GroundImage {
  cv::Mat image;  ///< CV_8UC1 or CV_8UC3 (BGR)
  const RigCamera* camera = nullptr;
  Rigid3 site_from_camera;
  Rigid3 site_from_ground;  ///< of the car: its own contact area is not looked at
  WheelbaseFootprint contact;
  int drive = 0;                               ///< that took it
  std::uint32_t index = 0;                     ///< among the images that paint
  ExposureAndVignetting light = {};            ///< brings the image to the light of the others
  std::optional<Eigen::Vector3d> to_sun = {};  ///< FindSun of the drive, once that is known
  VisibilityHorizon open_ground = {};          ///< what it shows of the ground
};

/// Where an image shows a point of the ground, and how steeply.
struct GroundPixel {
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  /// Sine of the depression, less in what may be the own shade, next to nothing in what is; 0: not
  /// seen.
  float steepness = 0;
};

/// How an image sees a point; not at all beyond `max_range` [m] (horizontally) from the camera,
/// where something stands in the way, or on another deck than the car's: its own floor is what a
/// image shows there. The image is not needed.
GroundPixel SeePoint(const GroundImage& image, const Rigid3& camera_from_site,
                     const Eigen::Vector3d& point_in_site, double max_range);

/// Median of cells' blue, green and red over those of the image at the same places: what it has to
/// be multiplied by to look like the surface; 1 where too little is seen. Within [1/3, 3].
Eigen::Array3f FindGain(const GroundImage& image, const CellFinder& cells, double max_range);

inline std::uint8_t ToByte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

}  // namespace parkade

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
#include "mapping/texture/own_shade.h"

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

/// How an image sees points. Borrows the image, whose pixels are not needed.
class GroundProjector {
 public:
  /// \param max_range  [m] horizontally from the camera, beyond which nothing is seen
  GroundProjector(const GroundImage& image, double max_range);

  /// Nothing where something stands in the way, or on another deck than the car's: its own floor is
  /// what an image shows there.
  GroundPixel See(const Eigen::Vector3d& point_in_site) const;

  /// The pixel of a point, whatever stands in between: the own car and other decks alone count.
  std::optional<Eigen::Vector2d> PixelOf(const Eigen::Vector3d& point_in_site) const;

 private:
  std::optional<Eigen::Vector2d> PixelOf(const Eigen::Vector3d& point_in_site,
                                         const Eigen::Vector3d& point_in_ground) const;
  double LitShare(const Eigen::Vector2d& point_in_ground) const;

  const GroundImage* image_;
  double max_range_;
  Rigid3 camera_from_site_, ground_from_site_;
  ShadeCaster car_;
  std::optional<Eigen::Vector3d> to_sun_in_ground_;
};

/// Median of cells' blue, green and red over those of the image at the same places: what it has to
/// be multiplied by to look like the surface; 1 where too little is seen. Within [1/3, 3].
Eigen::Array3f FindGain(const GroundImage& image, const CellFinder& cells, double max_range);

inline std::uint8_t ToByte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

}  // namespace parkade

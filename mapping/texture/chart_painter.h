#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "core/rig.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/ground/wheelbase_footprint.h"
#include "mapping/surface/best_observations.h"
#include "mapping/surface/visibility_horizon.h"
#include "mapping/texture/exposure_and_vignetting.h"
#include "mapping/texture/texture_charts.h"

namespace parkade {

/// One image of the ground, and from where it was taken.
struct GroundImage {
  cv::Mat image;  ///< CV_8UC1 or CV_8UC3 (BGR)
  const RigCamera* camera = nullptr;
  Rigid3 site_from_camera;
  Rigid3 site_from_ground;  ///< of the car: its own contact area is not looked at
  WheelbaseFootprint contact;
  int drive = 0;                       ///< that took it
  std::uint32_t index = 0;             ///< among the images that paint
  ExposureAndVignetting light = {};    ///< brings the image to the light of the others
  VisibilityHorizon open_ground = {};  ///< what it shows of the ground
};

/// Where a image shows a point of the ground, and how steeply.
struct GroundPixel {
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  float steepness = 0;  ///< sine of the depression, less in what may be the own shade; 0: not seen
};

/// How a image sees a point; not at all beyond `max_range` [m] (horizontally) from the camera,
/// where something stands in the way, or on another deck than the car's: its own floor is what a
/// image shows there. The image is not needed.
GroundPixel SeePoint(const GroundImage& image, const Rigid3& camera_from_site,
                     const Eigen::Vector3d& point_in_site, double max_range);

/// Paints one chart. Each texel keeps the few steepest observations of it; what the most of them
/// agree on wins, so that what passes by vanishes. The latest drive shows a place wherever it saw
/// it well: days differ in light, and mixed they leave a seam around every image. Not thread-safe;
/// charts are independent of each other.
class ChartPainter {
 public:
  explicit ChartPainter(BlankChart blank, double texel_size);

  /// Texels further than `max_range` [m] (horizontally) from the camera are left alone. Images come
  /// drive by drive, the latest last.
  void Paint(const GroundImage& image, double max_range);

  /// The image; texels without a observation have the color of their cell, those off the mesh that
  /// of the nearest texel on it.
  TextureChart Finish(const CellFinder& cells);

 private:
  static constexpr std::size_t kNumObservations = 4;  // kept per texel: the steepest
  static constexpr int kTexelsPerStep = 4;            // between exact projections; linear inside

  using Observations = BestObservations<kNumObservations>;  ///< rank: 1 + 254 steepness

  /// Blocks of texels: the first column and row, and how many of each.
  struct Part {
    int column = 0, row = 0, width = 0, height = 0;
  };

  Part PartAround(const Eigen::Vector3d& eye, double max_range) const;
  cv::Mat1b FindWanted(const Part& part, const Eigen::Vector3d& eye) const;
  Eigen::Vector2d PlaceOf(double column, double row) const;
  /// [m] in site; nothing where no mesh is near.
  std::optional<Eigen::Vector3d> CornerAt(int column, int row) const;
  GroundPixel See(const GroundImage& image, const Rigid3& camera_from_site, int column, int row,
                  double max_range) const;
  /// How steeply a corner is seen from a place if nothing hides it; 0 or less: not at all.
  float SteepestAt(const Eigen::Vector3d& eye, int column, int row) const;
  /// The index of a block, or of the corner before it.
  std::size_t BlockAt(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(num_columns_) +
           static_cast<std::size_t>(column);
  }
  void BeginDrive(int drive);
  void StepBack(std::size_t texel);
  void PaintBlock(const GroundImage& image, const std::array<GroundPixel, 4>& corners, int column,
                  int row);
  static std::array<std::uint8_t, 3> Agree(const Observations& observations);

  BlankChart blank_;
  double texel_size_;
  int num_columns_ = 0, num_rows_ = 0;  ///< of corners
  std::vector<float> corner_heights_;   ///< [m] NaN where no mesh is near
  std::vector<Observations> observations_;
  std::vector<std::uint8_t>
      least_ranks_;  ///< per block: a image of this drive that ranks no higher adds nothing
  std::optional<int> drive_;    ///< whose images are being painted
  std::vector<bool> is_shown_;  ///< by it
};

/// Median of cells' blue, green and red over those of the image at the same places: what it has to
/// be multiplied by to look like the surface; 1 where too little is seen. Within [1/3, 3].
Eigen::Array3f FindGain(const GroundImage& image, const CellFinder& cells, double max_range);

}  // namespace parkade

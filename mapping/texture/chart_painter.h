#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "mapping/ground/cell_finder.h"
#include "mapping/surface/best_observations.h"
#include "mapping/texture/ground_image.h"
#include "mapping/texture/texture_charts.h"

namespace parkade {

/// Paints one chart. Each texel keeps the few steepest observations of it; what the most of them
/// agree on wins, so that what passes by vanishes. The latest drive shows a place wherever it saw
/// it well: days differ in light, and mixed they leave a seam around every image. Not thread-safe;
/// charts are independent of each other.
class ChartPainter {
 public:
  explicit ChartPainter(BlankChart blank, double texel_size);

  /// Announces all images of a drive (one at least), before the first is painted: where enough of
  /// them show the ground more steeply, the rest need not be looked at.
  void Expect(std::span<const GroundImage* const> images, double max_range);

  /// Texels further than `max_range` [m] (horizontally) from the camera are left alone. Images come
  /// drive by drive, the latest last.
  void Paint(const GroundImage& image, double max_range);

  /// The image; texels without an observation have the color of their cell, those off the mesh that
  /// of the nearest texel on it.
  TextureChart Finish(const CellFinder& cells);

 private:
  static constexpr std::size_t kNumObservations = 4;  // kept per texel: the steepest
  static constexpr int kTexelsPerStep = 4;            // between exact projections; linear inside

  static constexpr int kStepsPerNode = 4;  // between places at which images are compared before

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
  GroundPixel SeeCorner(const GroundProjector& projector, int column, int row) const;
  /// The index of a block, or of the corner before it.
  std::size_t BlockAt(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(num_columns_) +
           static_cast<std::size_t>(column);
  }
  void BeginDrive(int drive);
  cv::Mat_<cv::Vec4b> BestRanks(std::span<const GroundImage* const> images, double max_range) const;
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
      least_ranks_;  ///< per block: an image of this drive that ranks no higher adds nothing
  std::optional<int> drive_;    ///< whose images are being painted
  std::vector<bool> is_shown_;  ///< by it
};

}  // namespace parkade

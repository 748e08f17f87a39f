#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace parkade {

/// Remembers by cells of an image whether new tracks live to see the next image. Where they do not
/// (asphalt that rushes by below a camera, glare, noise) a cell rests most of the time: to detect,
/// follow and match what is lost at once cost a tenth of tracking.
class BarrenCells {
 public:
  /// \param cell_size  [px]
  BarrenCells(int width, int height, int cell_size);

  /// A track that began at `pixel` in the last image was found in this one, or was not.
  void Note(const Eigen::Vector2d& pixel, bool was_found);

  /// Whether no track is worth beginning at `pixel` in image number `image`: few of the last ones
  /// in this cell lived, and it is not its turn to be tried again.
  bool Rests(const Eigen::Vector2d& pixel, std::int64_t image) const;

 private:
  size_t CellOf(const Eigen::Vector2d& pixel) const;

  int cell_size_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<float> survival_;  ///< share of the latest tracks that lived, per cell
};

}  // namespace parkade

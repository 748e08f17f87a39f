#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace parkade {

/// Learns which parts of a camera's image show the car itself (or dirt on the
/// lens): what stays still in the image while the camera turns. Only rotation
/// tells: far points stay still too while a car drives straight.
class EgoMask {
 public:
  EgoMask(int width, int height);

  /// One track's step between two images; counts for all that its patch touches.
  ///
  /// \param if_fixed_to_world  [px] where rotation alone would have moved it
  void Add(const Eigen::Vector2d& before, const Eigen::Vector2d& after,
           const Eigen::Vector2d& if_fixed_to_world);

  bool IsEgoVehicle(const Eigen::Vector2d& pixel) const;

  /// `usable` with the pixels of the car's body set to 0.
  cv::Mat Exclude(const cv::Mat& usable) const;

  /// Increases whenever a cell changes its answer.
  int version() const { return version_; }

 private:
  struct Cell {
    int still = 0;  ///< steps of tracks that stayed while the camera turned
    int moved = 0;  ///< steps of tracks that went along with the world
    bool is_ego = false;
  };

  std::optional<size_t> CellAt(const Eigen::Vector2d& pixel) const;

  int columns_ = 0;
  int rows_ = 0;
  int version_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace parkade

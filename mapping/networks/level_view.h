#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "core/camera_model.h"
#include "core/rigid3.h"

namespace parkade {

/// Images of a wide lens as the network of level views takes them: columns are azimuths, rows are
/// elevations against the plane of the ground, and rows lie dense where the ground is far. Ground
/// between 4 and 12 m, a few dozen rows of a fisheye's image, gets about as many again; sky and the
/// ground at the car's foot, which are easy, get fewer. In all it has as many pixels as an image of
/// 640 x 384 (training/level_view.py trains on the same).
///
/// Immutable once made, hence thread-safe.
class LevelView {
 public:
  static constexpr int kWidth = 832, kHeight = 288;  ///< [px]

  /// Nothing where the image fills less than half of the ground in such a view: of a narrow lens it
  /// would show less than the image does. \param ground_from_camera  z of frame `ground` is up
  static std::optional<LevelView> Of(const CameraModel& model, const Rigid3& ground_from_camera);

  /// kWidth x kHeight; black off the image. `image` has the model's size, and one or three
  /// channels.
  cv::Mat Show(const cv::Mat& image) const;

  /// [px] of the view where a direction (of any length) appears; beyond the view where it shows
  /// none.
  Eigen::Vector2f PixelOf(const Eigen::Vector3d& direction_in_ground) const;

 private:
  LevelView() = default;

  double heading_ = 0;          ///< [rad] of the middle column, from the ground's x to its y
  cv::Size image_;              ///< [px] that an image is reduced to before
  cv::Mat places_, fractions_;  ///< pixels of that, for cv::remap
};

}  // namespace parkade

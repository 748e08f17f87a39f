#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/matx.hpp>

#include "core/rig.h"

namespace parkade {

/// An image of the ground around a keyframe from above, in the frame of the keyframe: row 0 is
/// ahead, column 0 to the left. Cells of kFloorCell; the middle of cell (row, column) is x =
/// kFloorFront - (row + 0.5) kFloorCell, y = kFloorLeft - (column + 0.5) kFloorCell. CV_8UC1:
/// kFloorGray is as bright as the ground around as the same camera shows it, 0 is where no camera
/// sees the ground, or where the areas that two cameras show meet.
constexpr double kFloorCell = 0.05;  ///< [m]
constexpr double kFloorFront = 6;    ///< [m] ahead of the rear axle
constexpr double kFloorLeft = 5;     ///< [m] to either side
constexpr double kFloorGray = 128;   ///< as bright as the ground around
/// Cells: to 4 m behind the axle, and as far to the right as to the left.
inline const cv::Size kFloorSize(200, 200);

/// What one camera shows of the ground.
struct GroundBev {
  cv::Mat image;      ///< as above
  cv::Mat sharpness;  ///< CV_32FC1 [px/m] of the image across the cell in its worse direction; 0
                      ///< where unseen
  cv::Mat camera;     ///< CV_8UC1, which one
};

/// The ground as one camera of a car sees it, which stands on the plane z = 0 of its body.
/// Immutable, thread-safe.
class GroundBevView {
 public:
  GroundBevView() = default;  ///< sees nothing
  explicit GroundBevView(const RigCamera& camera);

  /// \param image            CV_8UC1 of the calibrated size
  /// \param keyframe_from_body when the image was taken; its tilt is left out
  /// \param camera its number, which GroundBev::camera will hold
  GroundBev Look(const cv::Mat& image, const Rigid3& keyframe_from_body, int camera) const;

 private:
  /// The image relative to the brightness of the ground around, which becomes kFloorGray. Unseen
  /// cells are kFloorGray.
  cv::Mat WithoutLight(const cv::Mat& image) const;

  cv::Rect box_;                ///< of the floor, around what is seen
  cv::Mat places_, fractions_;  ///< of cv::remap, at half the cell size; of the box, like the rest
  cv::Mat sharpness_;           ///< CV_32FC1, in the frame of the body
  cv::Mat weights_, weights_around_;  ///< CV_32FC1: 1 where seen, and WeightsAround it
};

/// The affine map that moves images of the ground from one frame to another, both upright.
cv::Matx23f MoveOfFloor(const Rigid3& to_from);

/// Takes over the cells that `observation` shows more sharply than what is there. Both start empty.
void AddObservation(const GroundBev& observation, GroundBev& floor);

/// The image of all observations together, without the seams between them.
cv::Mat ImageOf(const GroundBev& floor);

}  // namespace parkade

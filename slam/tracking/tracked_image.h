#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/camera_model.h"
#include "core/timestamp.h"
#include "slam/tracking/feature_track.h"

namespace parkade {

/// One image as a FeatureTracker left it: what is needed to look for its tracks
/// in another image. Copies are cheap: pixels are shared and never written again.
struct TrackedImage {
  Timestamp time;
  int camera = 0;
  CameraModel model;
  Eigen::Vector3d up_in_camera =
      Eigen::Vector3d::Zero();  ///< unit, z of the body: the ground's normal
  /// Made by BuildPyramid: locally normalized.
  std::vector<cv::Mat> pyramid;
  cv::Mat
      usable;  ///< CV_8UC1 of the image's size, 0 = masked, own body, or outside the image circle
  std::vector<FeatureObservation> observations;  ///< those of the TrackedFrame

  bool empty() const { return pyramid.empty(); }
};

}  // namespace parkade

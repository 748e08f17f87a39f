#pragma once

#include <Eigen/Core>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "core/rigid3.h"
#include "core/timestamp.h"

namespace parkade {

/// One corner of one image, as a ray in the frame of its keyframe.
struct KeyframeFeature {
  int camera = 0;
  Eigen::Vector3d origin;   ///< [m] of the camera when it took the image
  Eigen::Vector3d bearing;  ///< unit
  double sigma = 1e-3;      ///< [rad]
  /// Where it lies in its image, in shares of its width and height; negative: not in an image of
  /// this keyframe, or not known.
  Eigen::Vector2f image_point{-1, -1};
  /// Where the drive's own motion shows how far away it is [m], and how surely along the ray [m].
  std::optional<Eigen::Vector3d> point;
  double depth_sigma = 0;
};

/// What all cameras saw at one spot of a drive. The frame of a keyframe is the body, leveled: z up,
/// x along the heading.
struct RigKeyframe {
  Timestamp time;
  double distance = 0;  ///< [m] driven until here
  Rigid3 odom_from_keyframe;
  std::vector<KeyframeFeature> features;
  cv::Mat descriptors;  ///< CV_8UC1, one row of 32 bytes (ORB) per feature
  std::vector<cv::Mat> views =
      {};  ///< small images for people, one per camera; CV_8UC1, may be empty
  std::vector<Timestamp> image_times = {};  ///< of each camera's image; may be empty
  cv::Mat floor = {};  ///< the ground from above (ground_bev.h); empty where the rig has no vehicle
};

/// The frame of a rig keyframe where the car is at `odom_from_body`.
inline Rigid3 LeveledPose(const Rigid3& odom_from_body) {
  const Eigen::Vector3d forward = odom_from_body.rotation * Eigen::Vector3d::UnitX();
  return {ExpSo3({0, 0, std::atan2(forward.y(), forward.x())}), odom_from_body.translation};
}

}  // namespace parkade

#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/option_about.h"
#include "core/rigid3.h"
#include "core/timestamp.h"

namespace parkade {

struct RelativePoseOptions {
  int max_hamming = 64;          ///< bits of 256 in which features that match may differ
  double ratio = 0.9;            ///< of the best to the second best match
  int iterations = 150;          ///< of RANSAC
  double max_error = 3.5;        ///< [sigma] of inliers
  double max_tilt_deg = 1.5;     ///< by which the two keyframes' gravity may differ
  int min_guiding_inliers = 12;  ///< with which a pose guides the search for more matches
  int min_inliers = 25;          ///< from two cameras or more ...
  int min_inliers_of_one = 40;   ///< ... or from one
  double max_sigma = 0.3;        ///< [m] of the worst direction
  // How far each camera's mount may still be off after calibration: all loops that a camera sees
  // share that.
  double mount_rotation_deg = 0.06;
  double mount_translation = 0.015;  ///< [m]

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("min_inliers", min_inliers,
          OptionAbout{"A loop needs this many matches that agree, from two cameras or more.", "", 3,
                      1000});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Features of two keyframes that look alike.
struct FeatureMatch {
  size_t a = 0, b = 0;
};

/// Matches between one camera of keyframe `a` and one of keyframe `b` that agree with the pose.
struct CameraPairInliers {
  int camera_a = 0, camera_b = 0, count = 0;
};

/// A point in two images, in shares of their widths and heights.
struct MatchedPoint {
  Eigen::Vector2f a, b;
};

/// What shows people why two keyframes are believed to see the same: the inliers of the two cameras
/// that share the most.
struct ShownInliers {
  int camera_a = 0, camera_b = 0;
  Timestamp image_a, image_b;        ///< when they were taken
  std::vector<MatchedPoint> points;  ///< some of them; none where images are not known
};

/// Where keyframe `b` lies in the frame of keyframe `a`, and how well that is known.
struct RelativePose {
  Rigid3 a_from_b;
  Matrix6d information = Matrix6d::Zero();  ///< about RelativePoseError(measured, actual)
  int num_matches = 0, num_inliers = 0, num_camera_pairs = 0;
  int num_first_inliers = 0;  ///< before the pose guided the search for more
  std::vector<CameraPairInliers> inliers_of_cameras;  ///< the most first
  ShownInliers shown = {};
  double residual = 0;     ///< [sigma] RMS of the inliers' angles
  double worst_sigma = 0;  ///< [m] of the worst direction
  std::string rejected;    ///< empty: good; else why not, in a few words
};

/// Cameras by their numbers; times in decimal seconds, points as [x_a, y_a, x_b, y_b].
nlohmann::json ToJson(const ShownInliers& shown);

}  // namespace parkade

#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/option_about.h"
#include "core/trajectory.h"
#include "slam/places/describe_keyframes.h"
#include "slam/places/place_recognition.h"
#include "slam/places/relative_pose.h"

namespace parkade {

struct LoopOptions {
  std::string method = "rig";  ///< "rig", "scale-less", "rotation-only", "pnp" or "none"
  KeyframeOptions keyframes;
  RecognitionOptions recognition;
  RelativePoseOptions relative_pose;
  // Random walk of the odometry over a way of d meters: sigma = value * sqrt(d). Where the odometry
  // gives a covariance, that counts instead, within 0.3 to 2 times these.
  double odometry_translation = 0.003;  ///< [m / sqrt(m)]
  double odometry_yaw = 0.0006;         ///< [rad / sqrt(m)]
  double odometry_tilt = 0.0005;        ///< [rad] of roll and pitch, which do not drift
  double shared_reach = 8;  ///< [m] within which loops see the same and share what they know

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit(
        "method", method,
        OptionAbout{"Loops are closed by the whole rig (\"rig\"), by a baseline of the literature "
                    "(\"scale-less\", \"rotation-only\", \"pnp\"), or not at all (\"none\")."});
    visit("places", keyframes);
    visit("recognition", recognition);
    visit("relative_pose", relative_pose);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// What a person decided about single loops, by LoopEvidence::id.
struct LoopReview {
  std::vector<std::string> rejected = {};  ///< never close
  std::vector<std::string> forced = {};  ///< close without doubt, where they can be measured at all

  bool empty() const { return rejected.empty() && forced.empty(); }
};

/// One pair of keyframes that looked alike, and what became of it.
struct LoopEvidence {
  std::string id;  ///< "EARLIER-LATER", the keyframes' numbers along the drive: the same for the
                   ///< same odometry
  size_t earlier_keyframe = 0, later_keyframe = 0;
  int earlier_camera = 0, later_camera = 0;  ///< that share the most inliers
  Timestamp earlier, later;
  double way = 0;                                 ///< [m] driven between
  double score = 0;                               ///< by place recognition
  RelativePose pose;                              ///< of the later in the earlier keyframe
  Rigid3 earlier_from_camera, later_from_camera;  ///< of a loop without scale: what its factor ties
  bool is_forced = false;                         ///< by a reviewer
  double share = 1;                  ///< of its information that counts, beside its neighbors
  double chi_squared = 0;            ///< [sigma^2] of the loop once all are closed
  double weight = 0;                 ///< 1 where the pose graph believed it
  double odometry_disagreement = 0;  ///< [m] how far off odometry alone put the later keyframe
};

/// What cameras saw at keyframes of loops, small, for people: JPEG by keyframe and camera.
using LoopViews = std::map<std::pair<size_t, int>, std::string>;

struct LoopClosure {
  Trajectory odom_from_body;  ///< corrected, at the times of the odometry; the odometry itself
                              ///< without loops
  std::vector<LoopEvidence> loops;
  LoopViews views;  ///< of the loops' cameras, where the log has images
  int num_keyframes = 0, num_accepted = 0;
  double largest_correction = 0;  ///< [m]
  double seconds = 0;             ///< of computing
};

nlohmann::json ToJson(const LoopClosure& closure);

}  // namespace parkade

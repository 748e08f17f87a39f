#pragma once

#include <functional>

#include "core/drive_log.h"
#include "core/option_about.h"
#include "core/trajectory.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

struct KeyframeOptions {
  double spacing = 2;             ///< [m] between keyframes
  double spacing_deg = 25;        ///< a turn of this much makes a keyframe too
  int max_features = 400;         ///< kept per image
  double max_distance = 40;       ///< [m] of points that are believed
  double max_depth_error = 0.15;  ///< sigma / distance above which a point is not believed

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("spacing", spacing,
          OptionAbout{"The rig's keyframes lie this far apart along the drive.", "m", 0.5, 20});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Places keyframes along the drive, without features.
std::vector<RigKeyframe> ChooseKeyframes(const Trajectory& odom_from_body,
                                         const KeyframeOptions& options);

using KeyframeSink = std::function<void(RigKeyframe&& keyframe)>;

/// Looks again at images of the keyframes that are wanted (one flag each), one per camera and
/// keyframe: corners with ORB descriptors on upright views (CylinderView), and where neighboring
/// keyframes see a corner too, its point by the odometry's motion. One pass over the log; images
/// are worked on in parallel batches. `sink` gets all keyframes in their order as they are done:
/// only some dozens are in memory with their features.
void DescribeKeyframes(const DriveLog& log, const Trajectory& odom_from_body,
                       const KeyframeOptions& options, const std::vector<bool>& is_wanted,
                       std::vector<RigKeyframe> keyframes, const KeyframeSink& sink);

/// Keyframes before and after one that see the same corners.
inline constexpr size_t kNeighborKeyframes = 2;

/// The features of keyframe `index` with points from matching features of the same camera at its
/// neighbors.
std::vector<KeyframeFeature> TriangulateFeatures(const std::vector<RigKeyframe>& keyframes,
                                                 size_t index, const KeyframeOptions& options);

}  // namespace parkade

#pragma once

#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"
#include "slam/places/triangulation_queue.h"

namespace parkade {

/// Where a drive's car and cameras were, by one estimate. Borrowed.
struct PlacedDrive {
  const Trajectory& odom_from_body;
  const Rig& rig;
};

/// Takes keyframes that were described along one estimate of a drive to a better one, whose
/// trajectory and cameras' mounts and times are a little different: what the images show stays, and
/// the rays and points of features become those of the better one; no image is read again. Floors
/// stay as they are: what a refinement changes about mounts is small against their cells of 5 cm.
class KeyframeMover {
 public:
  /// `moved` are all keyframes, without features, where the better estimate puts them. `options` is
  /// borrowed. `sink` gets the keyframes in their order, with points by the motion of `to`.
  KeyframeMover(const PlacedDrive& from, const PlacedDrive& to, std::vector<RigKeyframe> moved,
                const KeyframeOptions& options, KeyframeSink sink);

  /// The next keyframe as it was described along `from`. After the last one, all have gone to the
  /// sink.
  void Add(RigKeyframe described);

 private:
  PlacedDrive from_, to_;
  TriangulationQueue queue_;
  size_t num_added_ = 0;
};

}  // namespace parkade

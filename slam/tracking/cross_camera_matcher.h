#pragma once

#include <vector>

#include "core/rig.h"
#include "core/rigid3.h"
#include "slam/tracking/feature_track.h"
#include "slam/tracking/tracked_image.h"

namespace parkade {

struct CrossCameraOptions {
  double min_depth =
      1.5;  ///< [m] along the ray, or 5 baselines where that is less; nearer: not looked for
  double min_similarity = 0.65;  ///< normalized correlation in [-1, 1] that a match must reach
  double max_epipolar_error =
      2.0;                   ///< [px] off the epipolar line; allows for errors of the extrinsics
  double pixel_sigma = 0.5;  ///< [px] noise reported with each observation
  void Validate() const;     ///< throws Error{kUsage}
};

/// Share of the image of `a` whose rays, somewhere between `min_depth` [m] and
/// infinity, meet the image of `b`: 0 = the cameras never see the same point.
/// Geometry only; worth asking once per pair of cameras.
double ViewOverlap(const RigCamera& a, const RigCamera& b, double min_depth = 1.5);

/// Looks for the tracks of one image in an image of ANOTHER camera, taken at
/// (nearly) the same time: search along the epipolar curve from infinity to
/// `min_depth` with patches warped through both lenses, sub-pixel alignment,
/// backward check, epipolar check, ambiguous matches refused.
///
/// \param to_from_from  camera frame of `to` from camera frame of `from` at their
///     two times: the extrinsics, and the car's motion in between where it matters.
/// \return observations in `to` that carry the track numbers of `from`, in the
///     order of from.observations; fewer where views do not overlap.
///
/// Without motion this is what gives scale. Pure function, thread-safe.
std::vector<FeatureObservation> MatchAcross(const TrackedImage& from, const TrackedImage& to,
                                            const Rigid3& to_from_from,
                                            const CrossCameraOptions& options = {});

}  // namespace parkade

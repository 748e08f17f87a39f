#pragma once

#include <vector>

#include "slam/tracking/feature_tracker.h"
#include "tests/simulator/motion/motion.h"
#include "tests/simulator/scenes/scene.h"
#include "tests/simulator/sensors/sensors.h"

namespace parkade::simulator {

/// What the real front end makes of rendered images: the measure for track mode.
struct RenderedTracks {
  std::vector<TrackedFrame> frames;  ///< of all cameras, in order of time; own tracks only
  std::vector<std::vector<FeatureObservation>> crossed;  ///< per frame: what MatchAcross adds to it
  double render_seconds = 0;                             ///< per image
  double track_seconds = 0;                              ///< per image
};

/// A stretch of a drive to be rendered.
struct Stretch {
  double begin = 0, end = 0;  ///< [s] after the drive's begin
  CameraClockOptions cameras;
};

/// Renders and tracks the images of a stretch; the rig's cameras get masks from
/// the renderer. Rotations between frames come from the true motion. Slow: a
/// third of a second per image.
RenderedTracks TrackRenderedDrive(const Scene& scene, const Rig& rig, const Motion& motion,
                                  const Stretch& stretch, std::uint64_t seed,
                                  const FeatureTrackerOptions& options = {});

}  // namespace parkade::simulator

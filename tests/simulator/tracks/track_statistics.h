#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/tracking/feature_track.h"
#include "tests/simulator/tracks/track_eye.h"
#include "tests/simulator/tracks/track_world.h"

namespace parkade::simulator {

/// How far tracks of one age are from where they should be: the surface point
/// that the first observation looked at, seen from the true pose.
struct TrackErrorAtAge {
  int age = 0;          ///< frames after the first
  size_t count = 0;     ///< observations
  double survival = 0;  ///< share of tracks that live to this age and beyond (Kaplan-Meier: lives
                        ///< cut by the end are fair)
  double along = 0;     ///< [px] robust standard deviation along the flow of the point (1.4826 MAD)
  double across = 0;    ///< [px] across it
  double gross = 0;     ///< share of errors above 3 px
};

/// What the tracks of one camera are like.
struct TrackStatistics {
  double tracks_per_frame = 0;
  double new_per_frame = 0;
  double step =
      0;  ///< [px] robust standard deviation per axis of the change of the error, frame to frame
  double stuck = 0;      ///< share of observations that hardly moved while their point should have:
                         ///< shadow, mirrors
  double outliers = 0;   ///< share of observations above 3 px
  double on_ground = 0;  ///< share of tracks that began on the ground,
  double in_sky = 0;     ///< and in the sky
  double near = 0, middle = 0, far = 0;  ///< [m] quartiles of the first distance, without the sky
  std::vector<TrackErrorAtAge> ages;
};

/// Looks at the frames of one camera, in order of time; frames without
/// observations do not count. Observations of other cameras' tracks are left out.
TrackStatistics MeasureTracks(const std::vector<TrackedFrame>& frames, const TrackEye& eye,
                              TrackWorld& world);

/// A few lines for people.
std::string ToText(const TrackStatistics& statistics);

}  // namespace parkade::simulator

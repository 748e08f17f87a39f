#pragma once

#include <cstddef>
#include <vector>

#include "core/rig.h"
#include "slam/tracking/cross_camera_matcher.h"
#include "tests/simulator/tracks/track_simulator.h"

namespace parkade::simulator {

/// Two cameras that see some things both.
struct CameraPair {
  size_t from = 0, to = 0;
};

// As slam's front end matches across cameras:
inline constexpr double kMaxPairTime = 0.06;    ///< [s] between two images that are matched
inline constexpr double kMatchInterval = 0.07;  ///< [s] between two images of a camera that are

/// The pairs, each once, that slam's front end would match across.
std::vector<CameraPair> OverlappingPairs(const Rig& rig);

/// The tracks of one image of one camera.
struct TrackedView {
  Timestamp time;  ///< true
  std::vector<LiveTrack> tracks;
};

/// Which tracks of an image slam's MatchAcross would find in a image of another camera: those that
/// both see and that look alike enough, refused by the same checks against the rig that the
/// odometry was given. They carry the errors that the tracks had, and their own.
class TrackCrossing {
 public:
  TrackCrossing(TrackWorld& world, const TrackModel& model, const CrossCameraOptions& options,
                std::uint64_t seed);

  std::vector<FeatureObservation> Match(const TrackSimulator& from, const TrackedView& image,
                                        const TrackSimulator& to, Timestamp to_time);

 private:
  struct Views;
  std::optional<Eigen::Vector2d> Find(const Views& views, const LiveTrack& track);
  bool IsPlausible(const Views& views, const LiveTrack& track,
                   const FeatureObservation& match) const;

  TrackWorld& world_;
  TrackModel model_;
  CrossCameraOptions options_;
  Random random_;
};

}  // namespace parkade::simulator

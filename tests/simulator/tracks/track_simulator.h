#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "slam/tracking/epipolar_check.h"
#include "slam/tracking/feature_tracker.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/tracks/track_eye.h"
#include "tests/simulator/tracks/track_model.h"
#include "tests/simulator/tracks/track_world.h"

namespace parkade::simulator {

/// A point that a camera follows. What it holds on to is fixed in the world, or to
/// something that moves, or, as a shadow of the own car, in the body.
struct LiveTrack {
  std::int64_t number = 0;
  int age = 0;  ///< images since the first
  Eigen::Vector3d anchor =
      Eigen::Vector3d::Zero();  ///< [m] in world, or in `mover`, or in body where `is_shadow`
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  const Mover* mover = nullptr;
  bool is_shadow = false;
  std::optional<Eigen::Vector3d>
      behind;               ///< [m] in world, what shows past an outline in the same pixel
  double behind_share = 0;  ///< of the track's hold on it
  double roughness = 1;     ///< of its noise
  double frailty = 1;       ///< of its chance to be lost
  Eigen::Vector2d slide =
      Eigen::Vector2d::Zero();  ///< along and across the flow, in units of TrackModel's
  Eigen::Vector2d drift = Eigen::Vector2d::Zero();        ///< [px] that it has walked
  Eigen::Vector2d true_pixel = Eigen::Vector2d::Zero();   ///< in the last image
  FeatureObservation seen;                                ///< in the last image, with errors
  Eigen::Vector3d seen_before = Eigen::Vector3d::Zero();  ///< unit, its bearing one image earlier
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();          ///< [m] in world, then
};

/// Follows points of a world through the images of one camera as slam's
/// FeatureTracker follows corners: as many, spread as evenly, lost and erring in
/// the same ways, and checked by the same epipolar geometry. Same seed, same tracks.
class TrackSimulator {
 public:
  /// \param eye      of the true camera
  /// \param nominal  the camera as the odometry knows it: its lens makes bearings of pixels
  TrackSimulator(const TrackEye& eye, const RigCamera& nominal, int camera_index, TrackWorld& world,
                 const TrackModel& model, std::uint64_t seed,
                 const FeatureTrackerOptions& options = {});

  /// Takes the image whose middle row is exposed at `time`, which the camera stamps as `stamp`.
  TrackedFrame Track(Timestamp time, Timestamp stamp);

  /// A dark or covered lens: nothing is seen, and after a while all is forgotten.
  TrackedFrame Miss(Timestamp stamp) const { return {stamp, camera_, {}}; }

  const std::vector<LiveTrack>& tracks() const { return tracks_; }
  bool IsUsable(const Eigen::Vector2d& pixel) const;
  /// What the odometry is told of a pixel; nothing outside its lens.
  std::optional<FeatureObservation> Observe(std::int64_t track, const Eigen::Vector2d& pixel) const;
  /// [m] in world, what a track holds on to at `time`; not for shadows.
  Eigen::Vector3d PointOf(const LiveTrack& track, Timestamp time) const;
  const TrackEye& eye() const { return eye_; }
  const RigCamera& nominal() const { return nominal_; }

 private:
  std::optional<LiveTrack> Follow(LiveTrack track, Timestamp time);
  std::optional<Eigen::Vector2d> TruePixel(const LiveTrack& track, Timestamp time) const;
  void Slide(LiveTrack& track, const Eigen::Vector2d& flow, double growth, double sight_along_way);
  bool IsLost(const LiveTrack& track, double growth, double flow);
  void DropDisagreeing(std::vector<LiveTrack>& tracks, Timestamp time) const;
  void DropCrowded(std::vector<LiveTrack>& tracks) const;
  void AddCorners(Timestamp time);
  std::optional<LiveTrack> Corner(const Eigen::Vector2d& pixel, Timestamp time);
  bool IsAtOutline(LiveTrack& track, const SightLine& line, double distance, Timestamp time);
  bool IsOnOwnShadow(const Eigen::Vector3d& point, const Rigid3& world_from_body) const;
  Eigen::Vector2d Noise(double sigma);

  const TrackEye& eye_;
  const RigCamera& nominal_;
  int camera_ = 0;
  TrackWorld& world_;
  TrackModel model_;
  FeatureTrackerOptions options_;
  Random random_;
  cv::Mat usable_;
  int cell_size_ = 1;     ///< [px]
  double spacing_ = 0.6;  ///< [px] between new corners
  std::vector<LiveTrack> tracks_;
  std::optional<Timestamp> last_time_;
  std::int64_t next_track_ = 0;
};

}  // namespace parkade::simulator

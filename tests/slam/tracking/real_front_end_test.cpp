// The front end on the recorded clips of shared/data ($PARKADE_SHARED_DATA, or
// ../shared/data beside the repository). Skipped where they are absent.
#include <gtest/gtest.h>

#include <map>

#include "core/trajectory.h"
#include "slam/georeference/align_to_gnss.h"
#include "slam/tracking/cross_camera_matcher.h"
#include "slam/tracking/feature_tracker.h"
#include "tests/slam/worlds/real_clip.h"

namespace parkade {
namespace {

struct Summary {
  double tracks_per_frame = 0;
  double survival = 0;  ///< mean share of the tracks of one frame that the next one has
  size_t num_long = 0;  ///< tracks of 5 frames or more
  double median_creep =
      0;  ///< [px] of the tracks that lived through the clip, beyond their common motion
  FeatureTrackerStatistics statistics;
};

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Summary TrackClip(const RealClip& clip) {
  FeatureTracker tracker(clip.cameras[0], 0);
  std::map<std::int64_t, std::vector<Eigen::Vector2d>> tracks;
  Summary summary;
  size_t num_last = 0;
  const size_t count = clip.times[0].size();
  for (size_t i = 0; i < count; ++i) {
    const Eigen::Matrix3d rotation = i == 0
                                         ? Eigen::Matrix3d::Identity()
                                         : clip.Rotation(0, clip.times[0][i - 1], clip.times[0][i]);
    const TrackedFrame frame = tracker.Track(clip.Frame(0, i), rotation);
    size_t num_old = 0;
    for (const FeatureObservation& observation : frame.observations) {
      auto& history = tracks[observation.track];
      num_old += !history.empty();
      history.push_back(observation.pixel);
    }
    if (i > 0)
      summary.survival +=
          static_cast<double>(num_old) / static_cast<double>(num_last * (count - 1));
    summary.tracks_per_frame +=
        static_cast<double>(frame.observations.size()) / static_cast<double>(count);
    num_last = frame.observations.size();
  }
  std::vector<double> right, down, creep;
  for (const auto& [track, history] : tracks) {
    summary.num_long += history.size() >= 5;
    if (history.size() != count) continue;
    right.push_back(history.back().x() - history.front().x());
    down.push_back(history.back().y() - history.front().y());
  }
  for (size_t i = 0; i < right.size(); ++i)
    creep.push_back(std::hypot(right[i] - Median(right), down[i] - Median(down)));
  summary.median_creep = Median(creep);
  summary.statistics = tracker.statistics();
  return summary;
}

TEST(RealFrontEnd, ACarAtTwelveMetersPerSecondKeepsMostOfItsTracks) {
  const auto clip = LoadKittiClip();
  if (!clip) GTEST_SKIP() << "no kitti_06_clip";

  const Summary summary = TrackClip(*clip);

  EXPECT_EQ(summary.statistics.frames_tracked, 51);
  EXPECT_GT(summary.tracks_per_frame, 125);
  EXPECT_GT(summary.survival, 0.6);
  EXPECT_GT(summary.num_long, 350u);
}

TEST(RealFrontEnd, AFlightThroughARoomKeepsNearlyAll) {
  const auto clip = LoadEurocFlight();
  if (!clip) GTEST_SKIP() << "no euroc_v101_moving";

  const Summary summary = TrackClip(*clip);

  EXPECT_GT(summary.tracks_per_frame, 170);
  EXPECT_GT(summary.survival, 0.96);
  EXPECT_GT(summary.num_long, 350u);
}

TEST(RealFrontEnd, StandingStillNothingIsLostAndNothingCreeps) {
  const auto clip = LoadEurocStill();
  if (!clip) GTEST_SKIP() << "no euroc_v101_clip";

  const Summary summary = TrackClip(*clip);

  EXPECT_GT(summary.survival, 0.998);
  // The running propellers shake the image by up to 2 px as a whole (and the true pose by 0.2
  // degrees).
  EXPECT_LT(summary.median_creep, 0.35) << "[px] over 95 images";
  EXPECT_EQ(summary.statistics.lost_on_own_body, 0) << "a biased gyro is no turn";
}

/// Share of the matches whose depth and epipolar distance are possible; how many there are.
void ExpectStereo(const RealClip& clip, size_t index, size_t min_matches, double min_depth,
                  double max_depth) {
  FeatureTracker left(clip.cameras[0], 0), right(clip.cameras[1], 1);
  left.Track(clip.Frame(0, index), Eigen::Matrix3d::Identity());
  right.Track(clip.Frame(1, index), Eigen::Matrix3d::Identity());
  const Rigid3 right_from_left =
      clip.cameras[1].body_from_camera.Inverse() * clip.cameras[0].body_from_camera;

  const auto matches = MatchAcross(left.last_image(), right.last_image(), right_from_left);

  std::map<std::int64_t, Eigen::Vector3d> bearings;
  for (const FeatureObservation& track : left.last_image().observations)
    bearings[track.track] = track.bearing;
  EXPECT_GE(matches.size(), min_matches) << "of " << bearings.size();
  size_t num_in_range = 0;
  for (const FeatureObservation& match : matches) {
    const Eigen::Vector3d turned = right_from_left.rotation * bearings.at(match.track);
    const Eigen::Vector3d across = match.bearing.cross(right_from_left.translation);
    const double inverse_depth = -across.dot(match.bearing.cross(turned)) / across.squaredNorm();
    num_in_range += inverse_depth > 1 / max_depth && inverse_depth < 1 / min_depth;
  }
  EXPECT_GE(num_in_range, matches.size() * 95 / 100);
}

TEST(RealFrontEnd, StereoPairsOfACarMatchAtPlausibleDepths) {
  const auto clip = LoadKittiClip();
  if (!clip) GTEST_SKIP() << "no kitti_06_clip";

  ExpectStereo(*clip, 10, 90, 3, 500);
}

TEST(RealFrontEnd, StereoPairsInARoomMatchAtPlausibleDepths) {
  const auto clip = LoadEurocStill();
  if (!clip) GTEST_SKIP() << "no euroc_v101_clip";

  ExpectStereo(*clip, 10, 90, 0.8, 15);
}

}  // namespace
}  // namespace parkade

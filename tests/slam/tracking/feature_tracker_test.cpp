#include "slam/tracking/feature_tracker.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/error.h"
#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

/// A fisheye camera in a room, looking along room x, 20 frames per second.
class FeatureTrackerTest : public testing::Test {
 protected:
  /// Camera of a car that drives at 2 m/s on a curve; `steps` of 50 ms after the start.
  static Rigid3 PoseAt(int steps, double speed = 2.0, double turn_rate = 0.3) {
    const Rigid3 body_from_camera{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0, 0, 1}};
    const double seconds = 0.05 * steps, angle = turn_rate * seconds;
    return Rigid3{ExpSo3({0, 0, angle}), {speed * seconds - 2, 0.5 * speed * seconds * angle, 0}} *
           body_from_camera;
  }

  static Eigen::Matrix3d Rotation(const Rigid3& last, const Rigid3& now) {
    return (now.rotation.conjugate() * last.rotation).toRotationMatrix();
  }

  static CameraFrame Frame(int step, const cv::Mat& image) {
    return {Timestamp{1'000'000'000 + 50'000'000LL * step}, 0, image};
  }

  RigCamera Camera() const {
    RigCamera camera;
    camera.name = "cam0";
    camera.model = camera_.model();
    return camera;
  }

  /// Renders and tracks `count` steps from `first` on.
  std::vector<TrackedFrame> Drive(FeatureTracker& tracker, int first, int count) const {
    std::vector<TrackedFrame> frames;
    for (int step = first; step < first + count; ++step)
      frames.push_back(tracker.Track(Frame(step, camera_.Render(PoseAt(step), 1.0, step)),
                                     Rotation(PoseAt(std::max(0, step - 1)), PoseAt(step))));
    return frames;
  }

  /// [px] of every track of `now` off where the point of its pixel in `last` is.
  std::vector<double> Errors(const TrackedFrame& last, const Rigid3& last_pose,
                             const TrackedFrame& now, const Rigid3& now_pose) const {
    std::map<std::int64_t, Eigen::Vector2d> pixels;
    for (const FeatureObservation& observation : last.observations)
      pixels[observation.track] = observation.pixel;
    std::vector<double> errors;
    for (const FeatureObservation& observation : now.observations) {
      const auto found = pixels.find(observation.track);
      Eigen::Vector2d expected;
      if (found == pixels.end() || !camera_.Follow(found->second, last_pose, now_pose, &expected))
        continue;
      errors.push_back((observation.pixel - expected).norm());
    }
    std::sort(errors.begin(), errors.end());
    return errors;
  }

  RenderedRoom room_{{-6, -4, 0}, {6, 4, 3}, 3};
  RoomCamera camera_{SurroundFisheye(), room_};
};

TEST_F(FeatureTrackerTest, TracksStayOnTheirPoints) {
  FeatureTracker tracker(Camera(), 0);

  const std::vector<TrackedFrame> frames = Drive(tracker, 0, 12);

  for (size_t i = 1; i < frames.size(); ++i) {
    const auto step = static_cast<int>(i);
    const std::vector<double> errors =
        Errors(frames[i - 1], PoseAt(step - 1), frames[i], PoseAt(step));
    ASSERT_GE(errors.size(), 110u) << "step " << i;
    EXPECT_LT(errors[errors.size() / 2], 0.1) << "step " << i;
    EXPECT_LT(errors[errors.size() * 95 / 100], 0.5) << "step " << i;
  }
  const std::vector<double> drift = Errors(frames[0], PoseAt(0), frames[11], PoseAt(11));
  ASSERT_GE(drift.size(), 50u) << "tracks that lived through all 12 frames";
  EXPECT_LT(drift[drift.size() / 2], 0.4);
  RecordProperty("median_drift_px_12_frames", std::to_string(drift[drift.size() / 2]));
}

TEST_F(FeatureTrackerTest, ObservationsAreConsistentAndSpreadOverTheImage) {
  FeatureTracker tracker(Camera(), 2);
  const TrackedFrame frame = Drive(tracker, 0, 2).back();

  std::set<std::int64_t> tracks;
  int quarters[4] = {};
  for (const FeatureObservation& observation : frame.observations) {
    tracks.insert(observation.track);
    EXPECT_EQ(observation.track >> 40, 2);
    EXPECT_NEAR(observation.bearing.norm(), 1, 1e-12);
    EXPECT_LT((*camera_.model().Project(observation.bearing) - observation.pixel).norm(), 1e-6);
    EXPECT_NEAR(observation.sigma, 0.5 / *camera_.model().PixelsPerRadian(observation.pixel),
                1e-12);
    ++quarters[2 * (observation.pixel.y() > 200) + (observation.pixel.x() > 320)];
  }
  EXPECT_EQ(tracks.size(), frame.observations.size());
  EXPECT_GE(frame.observations.size(), 130u);
  EXPECT_LE(frame.observations.size(), 180u);
  for (const int count : quarters) EXPECT_GE(count, 20);
  EXPECT_EQ(tracker.last_image().observations.size(), frame.observations.size());
}

TEST_F(FeatureTrackerTest, FewTracksBeginWhereNoneLives) {
  FeatureTracker tracker(Camera(), 0);
  cv::RNG noise(7);
  std::int64_t last_track = -1;
  std::vector<int> begun_above, begun_below;
  for (int step = 0; step < 40; ++step) {
    cv::Mat image = camera_.Render(PoseAt(step), 1.0, step);
    cv::Mat below = image.rowRange(250, image.rows);  // another pattern in each image
    cv::Mat pattern(below.rows / 4, below.cols / 4, CV_8UC1);
    noise.fill(pattern, cv::RNG::UNIFORM, 60, 200);
    cv::resize(pattern, below, below.size(), 0, 0, cv::INTER_CUBIC);
    const TrackedFrame frame =
        tracker.Track(Frame(step, image), Rotation(PoseAt(std::max(0, step - 1)), PoseAt(step)));
    begun_above.push_back(0);
    begun_below.push_back(0);
    for (const FeatureObservation& seen : frame.observations)
      if (seen.track > last_track) ++(seen.pixel.y() > 250 ? begun_below : begun_above).back();
    for (const FeatureObservation& seen : frame.observations)
      last_track = std::max(last_track, seen.track);
  }

  const auto sum = [](const std::vector<int>& counts, int first) {
    return std::accumulate(counts.begin() + first, counts.begin() + first + 10, 0);
  };
  EXPECT_GT(begun_below[0], 20);
  EXPECT_LT(sum(begun_below, 30), 0.7 * sum(begun_below, 0)) << "they rest";
  EXPECT_GT(sum(begun_below, 30), 10) << "but are tried now and then";
  EXPECT_GT(sum(begun_above, 30), 20) << "where tracks live, new ones begin as before";
}

TEST_F(FeatureTrackerTest, PointsLeftBehindDoNotCrowdTheVanishingPoint) {
  const RenderedRoom corridor({-20, -4, 0}, {6, 4, 3}, 5);
  const RoomCamera camera(SurroundFisheye(), corridor);
  FeatureTracker tracker(Camera(), 0);
  TrackedFrame frame;
  for (int step = 0; step < 28; ++step) {  // 0.5 m backwards each
    const Rigid3 last = PoseAt(std::max(0, step - 1), -10, 0), now = PoseAt(step, -10, 0);
    frame = tracker.Track(Frame(step, camera.Render(now, 1.0, step)), Rotation(last, now));
  }

  const Eigen::Vector2d vanishing_point = *camera.model().Project(Eigen::Vector3d::UnitZ());
  double nearest = 1e9;
  int num_close = 0;
  for (size_t i = 0; i < frame.observations.size(); ++i) {
    const Eigen::Vector2d& pixel = frame.observations[i].pixel;
    num_close += (pixel - vanishing_point).norm() < 50;
    for (size_t j = 0; j < i; ++j)
      nearest = std::min(nearest, (frame.observations[j].pixel - pixel).norm());
  }
  EXPECT_GT(nearest, 9) << "[px]";
  EXPECT_LT(num_close, 50);
  EXPECT_GT(frame.observations.size(), 120u);
}

TEST_F(FeatureTrackerTest, APatchThatMovesOnItsOwnLosesItsTracks) {
  FeatureTracker tracker(Camera(), 0);
  cv::Mat patch(90, 120, CV_8UC1);
  cv::RNG(4).fill(patch, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(patch, patch, {}, 2);
  cv::normalize(patch, patch, 0, 255, cv::NORM_MINMAX);
  int on_patch = 0, old_on_patch = 0, old_elsewhere = 0;
  std::set<std::int64_t> known;

  for (int step = 0; step < 14; ++step) {
    cv::Mat image = camera_.Render(PoseAt(step), 1.0, step);
    const cv::Rect place(330 - 5 * step, 100 + 4 * step, patch.cols, patch.rows);
    patch.copyTo(image(place));
    const TrackedFrame frame =
        tracker.Track(Frame(step, image), Rotation(PoseAt(std::max(0, step - 1)), PoseAt(step)));
    for (const FeatureObservation& observation : frame.observations) {
      const bool is_on_patch =
          place.contains(cv::Point2d(observation.pixel.x(), observation.pixel.y()));
      const bool is_old = !known.insert(observation.track).second;
      on_patch += is_on_patch;
      old_on_patch += is_on_patch && is_old;
      old_elsewhere += !is_on_patch && is_old;
    }
  }

  EXPECT_GT(on_patch, 60) << "the detector does see the patch";
  EXPECT_LT(old_on_patch, 25) << "what was followed on it over fourteen frames";
  EXPECT_GT(old_elsewhere, 900);
  EXPECT_GT(tracker.statistics().lost_in_geometry, 20);
}

TEST_F(FeatureTrackerTest, MaskedPixelsAreNeverObserved) {
  RigCamera camera = Camera();
  camera.mask = cv::Mat(400, 640, CV_8UC1, cv::Scalar(255));
  camera.mask(cv::Rect(0, 260, 640, 140)) = 0;
  FeatureTracker tracker(camera, 0);

  const std::vector<TrackedFrame> frames = Drive(tracker, 0, 4);
  ASSERT_FALSE(frames.empty());
  for (const TrackedFrame& frame : frames) {
    EXPECT_GT(frame.observations.size(), 80u);
    for (const FeatureObservation& observation : frame.observations)
      EXPECT_LT(observation.pixel.y(), 260);
  }
}

TEST_F(FeatureTrackerTest, DarknessGivesFewerTracksNotNone) {
  FeatureTracker tracker(Camera(), 0);
  TrackedFrame frame;
  for (int step = 0; step < 6; ++step) {
    cv::Mat dim;
    camera_.Render(PoseAt(step), 0).convertTo(dim, CV_8UC1, 0.12, 4);
    cv::Mat noise(dim.size(), CV_8SC1);
    cv::RNG(static_cast<std::uint64_t>(step) + 1).fill(noise, cv::RNG::NORMAL, 0, 1.0);
    cv::add(dim, noise, dim, {}, CV_8UC1);
    frame = tracker.Track(Frame(step, dim), Rotation(PoseAt(std::max(0, step - 1)), PoseAt(step)));
  }

  EXPECT_GT(frame.observations.size(), 100u);
  EXPECT_LT(tracker.statistics().tracks_started, 420) << "most tracks live for several frames";
}

TEST_F(FeatureTrackerTest, ASuddenExposureChangeKeepsTheTracks) {
  for (const auto& [gain, offset] :
       {std::pair(0.5, 0.0), std::pair(1.5, 10.0), std::pair(0.7, -20.0)}) {
    FeatureTracker tracker(Camera(), 0);
    const TrackedFrame before = Drive(tracker, 0, 2).back();
    cv::Mat changed;
    camera_.Render(PoseAt(2), 1.0, 2).convertTo(changed, CV_8UC1, gain, offset);

    const TrackedFrame after = tracker.Track(Frame(2, changed), Rotation(PoseAt(1), PoseAt(2)));

    const std::vector<double> errors = Errors(before, PoseAt(1), after, PoseAt(2));
    ASSERT_GT(errors.size(), 105u) << "gain " << gain;
    EXPECT_LT(errors[errors.size() / 2], 0.15) << "gain " << gain;
  }
}

TEST_F(FeatureTrackerTest, AFastTurnIsFollowedThroughTheLens) {
  FeatureTracker tracker(Camera(), 0);
  const Rigid3 first = PoseAt(0, 1.0, 3.0),
               second = PoseAt(4, 1.0, 3.0);  // 34 degrees: 116 px at the center

  const TrackedFrame before =
      tracker.Track(Frame(0, camera_.Render(first)), Eigen::Matrix3d::Identity());
  const TrackedFrame after =
      tracker.Track(Frame(4, camera_.Render(second, 1.0, 4)), Rotation(first, second));

  const std::vector<double> errors = Errors(before, first, after, second);
  ASSERT_GT(errors.size(), 45u);
  EXPECT_LT(errors[errors.size() / 2], 0.3);
}

TEST_F(FeatureTrackerTest, BadFramesAreSkippedAndTracksContinueAfterThem) {
  FeatureTracker tracker(Camera(), 0);
  const TrackedFrame before = Drive(tracker, 0, 3).back();
  const Eigen::Matrix3d turn = Rotation(PoseAt(2), PoseAt(3));

  EXPECT_TRUE(
      tracker.Track(Frame(3, cv::Mat::zeros(400, 640, CV_8UC1)), turn).observations.empty());
  EXPECT_TRUE(
      tracker.Track(Frame(4, cv::Mat::zeros(100, 640, CV_8UC1)), turn).observations.empty());
  EXPECT_TRUE(tracker.Track(Frame(5, cv::Mat()), turn).observations.empty());
  EXPECT_TRUE(tracker.Track(Frame(5, cv::Mat(400, 640, CV_32FC1, 0.5)), turn).observations.empty());
  EXPECT_TRUE(tracker.Track(Frame(1, camera_.Render(PoseAt(1))), turn).observations.empty());
  // The rotations of the skipped frames were chained: 4 times the turn of one step, as from 2 to 6.
  const TrackedFrame after =
      tracker.Track(Frame(6, camera_.Render(PoseAt(6), 1.0, 6)), Eigen::Matrix3d::Identity());

  EXPECT_EQ(tracker.statistics().frames_blank, 1);
  EXPECT_EQ(tracker.statistics().frames_wrong_size, 3);
  EXPECT_EQ(tracker.statistics().frames_duplicate, 1);
  EXPECT_EQ(tracker.statistics().frames_tracked, 4);
  const std::vector<double> errors = Errors(before, PoseAt(2), after, PoseAt(6));
  ASSERT_GT(errors.size(), 70u);
  EXPECT_LT(errors[errors.size() / 2], 0.2);
}

TEST_F(FeatureTrackerTest, ARepeatedImageWhileMovingIsSkipped) {
  FeatureTracker tracker(Camera(), 0);
  Drive(tracker, 0, 3);

  const TrackedFrame repeated =
      tracker.Track(Frame(3, camera_.Render(PoseAt(2), 1.0, 2)), Rotation(PoseAt(2), PoseAt(3)));

  EXPECT_TRUE(repeated.observations.empty());
  EXPECT_EQ(tracker.statistics().frames_duplicate, 1);
}

TEST_F(FeatureTrackerTest, ALongPauseStartsNewTracks) {
  FeatureTracker tracker(Camera(), 0);
  const TrackedFrame before = Drive(tracker, 0, 2).back();

  const TrackedFrame after =
      tracker.Track(Frame(60, camera_.Render(PoseAt(1), 1.0, 9)), Eigen::Matrix3d::Identity());

  EXPECT_EQ(tracker.statistics().restarts, 1);
  EXPECT_GT(after.observations.size(), 100u);
  EXPECT_TRUE(Errors(before, PoseAt(1), after, PoseAt(1)).empty());
}

TEST_F(FeatureTrackerTest, StandingStillNothingMoves) {
  FeatureTracker tracker(Camera(), 0);
  TrackedFrame first, last;
  for (int step = 0; step < 20; ++step) {
    last = tracker.Track(Frame(step, camera_.Render(PoseAt(0), 1.0, step)),
                         Eigen::Matrix3d::Identity());
    if (step == 0) first = last;
  }

  const std::vector<double> errors = Errors(first, PoseAt(0), last, PoseAt(0));
  EXPECT_GT(errors.size(), first.observations.size() * 9 / 10);
  EXPECT_LT(errors[errors.size() / 2], 0.15);
}

TEST_F(FeatureTrackerTest, TheCarsOwnBodyIsLearnedInCurves) {
  FeatureTracker tracker(Camera(), 0);
  cv::Mat bonnet(80, 400, CV_8UC1);
  cv::RNG(4).fill(bonnet, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(bonnet, bonnet, {}, 2.5);
  cv::normalize(bonnet, bonnet, 0, 255, cv::NORM_MINMAX);
  const cv::Rect place(120, 310, bonnet.cols, bonnet.rows);
  std::vector<int> on_bonnet;

  for (int step = 0; step < 40; ++step) {
    cv::Mat image = camera_.Render(PoseAt(step, 1.5, 0.6), 1.0, step);
    bonnet.copyTo(image(place));
    const Rigid3 last = PoseAt(std::max(0, step - 1), 1.5, 0.6);
    const TrackedFrame frame =
        tracker.Track(Frame(step, image), Rotation(last, PoseAt(step, 1.5, 0.6)));
    on_bonnet.push_back(static_cast<int>(std::count_if(
        frame.observations.begin(), frame.observations.end(), [&](const FeatureObservation& seen) {
          return place.contains(cv::Point2d(seen.pixel.x(), seen.pixel.y()));
        })));
  }

  EXPECT_GT(on_bonnet.front(), 10);
  EXPECT_LT(on_bonnet.back(), on_bonnet.front() / 3);
}

TEST_F(FeatureTrackerTest, TwoRunsGiveTheSameBits) {
  FeatureTracker first(Camera(), 0), second(Camera(), 0);
  const TrackedFrame a = Drive(first, 0, 4).back(), b = Drive(second, 0, 4).back();

  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (size_t i = 0; i < a.observations.size(); ++i) {
    EXPECT_EQ(a.observations[i].track, b.observations[i].track);
    EXPECT_EQ(a.observations[i].pixel, b.observations[i].pixel);
  }
}

TEST(FeatureTrackerOptions, NonsenseIsRefused) {
  FeatureTrackerOptions options;
  options.window = 10;
  RigCamera camera;
  camera.model = SurroundFisheye();
  EXPECT_THROW(FeatureTracker(camera, 0, options), Error);
}

}  // namespace
}  // namespace parkade

#include "slam/loops/close_loops.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/slam/worlds/place_world.h"
#include "tests/slam/worlds/room_log.h"

namespace parkade {
namespace {

/// A drive along x with 1 m per second, one state per half second.
Trajectory StraightDrive(int num_states) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i < num_states; ++i) {
    TrajectoryState state;
    state.time = Timestamp{500'000'000LL * i};
    state.world_from_body = {ExpSo3({0, 0.02, 0}), {0.5 * i, 0, 0.1}};
    state.velocity_in_world = {1, 0, 0};
    states.push_back(state);
  }
  return Trajectory(std::move(states));
}

std::vector<RigKeyframe> KeyframesOf(const Trajectory& drive, size_t every) {
  std::vector<RigKeyframe> keyframes;
  for (size_t i = 0; i < drive.states().size(); i += every) {
    const TrajectoryState& state = drive.states()[i];
    keyframes.push_back({state.time,
                         state.world_from_body.translation.x(),
                         {Eigen::Quaterniond::Identity(), state.world_from_body.translation},
                         {},
                         {}});
  }
  return keyframes;
}

TEST(CarryAlong, KeyframesThatStayLeaveTheDriveAlone) {
  const Trajectory drive = StraightDrive(41);
  const std::vector<RigKeyframe> keyframes = KeyframesOf(drive, 4);
  std::vector<Rigid3> same;
  for (const RigKeyframe& keyframe : keyframes) same.push_back(keyframe.odom_from_keyframe);

  const Trajectory carried = CarryAlong(drive, keyframes, same);

  ASSERT_EQ(carried.states().size(), 41u);
  for (size_t i = 0; i < 41; ++i)
    EXPECT_LT((carried.states()[i].world_from_body.translation -
               drive.states()[i].world_from_body.translation)
                  .norm(),
              1e-12);
}

TEST(CarryAlong, StatesBetweenKeyframesMoveWithBoth) {
  const Trajectory drive = StraightDrive(43);  // ends between keyframes
  const std::vector<RigKeyframe> keyframes = KeyframesOf(drive, 4);
  // Each keyframe a bit farther to the left: 0.1 m per keyframe.
  std::vector<Rigid3> moved;
  for (size_t i = 0; i < keyframes.size(); ++i) {
    moved.push_back(keyframes[i].odom_from_keyframe);
    moved.back().translation.y() += 0.1 * static_cast<double>(i);
  }

  const Trajectory carried = CarryAlong(drive, keyframes, moved);

  EXPECT_NEAR(carried.At(Timestamp{4'000'000'000})->translation.y(), 0.2, 1e-12) << "at a place";
  EXPECT_NEAR(carried.At(Timestamp{5'000'000'000})->translation.y(), 0.25, 1e-12)
      << "half way to the next";
  EXPECT_NEAR(carried.states().back().world_from_body.translation.y(), 1.0, 1e-12)
      << "after the last place";
}

TEST(RecognizePlaces, FindsTheVisitBeforeAndNotThoseThatOdometryRulesOut) {
  // Three spots with looks of their own, visited twice; a fourth that looks like the first but lies
  // a deck above.
  std::vector<RigKeyframe> keyframes;
  const auto visit = [&keyframes](std::uint32_t looks, double distance,
                                  const Eigen::Vector3d& position) {
    RigKeyframe keyframe = MakePlaceWorld({.seed = looks}).a;
    keyframe.distance = distance;
    keyframe.odom_from_keyframe.translation = position;
    keyframes.push_back(keyframe);
  };
  for (int lap = 0; lap < 2; ++lap)
    for (std::uint32_t spot = 1; spot <= 3; ++spot)
      visit(spot, 100.0 * lap + 10.0 * spot, {10.0 * spot, 0.5 * lap, 0});
  visit(1, 200, {10, 0, 3});

  const std::vector<PlaceCandidate> candidates =
      RecognizePlaces(PlaceWords(keyframes), keyframes, {.max_candidates = 1});

  const auto found = [&](size_t earlier, size_t later) {
    return std::any_of(candidates.begin(), candidates.end(), [&](const PlaceCandidate& candidate) {
      return candidate.earlier == earlier && candidate.later == later && candidate.score > 0.5;
    });
  };
  for (const size_t spot : {0u, 1u, 2u}) EXPECT_TRUE(found(spot, spot + 3));
  EXPECT_FALSE(found(0, 6)) << "another deck";
  EXPECT_FALSE(found(3, 6));
}

TEST(FindPossibleRevisits, AStraightDriveHasNone) {
  const std::vector<RigKeyframe> straight = KeyframesOf(StraightDrive(401), 4);
  const std::vector<bool> possible = FindPossibleRevisits(straight, {});
  EXPECT_EQ(std::count(possible.begin(), possible.end(), true), 0);

  std::vector<RigKeyframe> back = straight;
  for (size_t i = 51; i < back.size(); ++i)
    back[i].odom_from_keyframe = back[100 - i].odom_from_keyframe;
  const std::vector<bool> of_return = FindPossibleRevisits(back, {});
  EXPECT_TRUE(of_return[0] && of_return[100]);
  EXPECT_FALSE(of_return[50]) << "where it turns, it has not driven far enough since";
}

// Odometry drifts to the left on the second of two laps through a room.
TEST(CloseLoops, BringsTheSecondLapBackOntoTheFirst) {
  constexpr int kLap = 70;
  const RoomLog log(2 * kLap, kLap);
  std::vector<TrajectoryState> states = log.Truth().states();
  for (size_t i = kLap; i < states.size(); ++i) states[i].world_from_body.translation.y() += 0.4;
  const Trajectory odometry(std::move(states));
  LoopOptions options;
  options.odometry_translation = 0.05;  // it knows that it drifts
  KeyframeStore described;
  const LoopClosure closure =
      CloseLoops(log, odometry, options, {.rejected = {"2-20"}, .forced = {"0-10"}}, described);

  EXPECT_GT(closure.num_accepted, 5);
  const TrajectoryState& last = closure.odom_from_body.states().back();
  EXPECT_LT(last.world_from_body.translation.y(), 0.1);
  const auto find = [&](const std::string& id) {
    return std::find_if(closure.loops.begin(), closure.loops.end(),
                        [&](const LoopEvidence& loop) { return loop.id == id; });
  };
  EXPECT_NE(find("0-10"), closure.loops.end()) << "too near for recognition, but a person said so";
  for (const LoopEvidence& loop : closure.loops) {
    EXPECT_TRUE(described.Has(loop.earlier) && described.Has(loop.later)) << loop.id;
    EXPECT_TRUE(closure.views.contains({loop.earlier_keyframe, loop.earlier_camera}));
  }
}

TEST(LoopOptions, UnknownMethodsAreRefused) {
  LoopOptions options;
  options.method = "guess";
  EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade

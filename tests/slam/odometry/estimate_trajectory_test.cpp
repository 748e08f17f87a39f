// Odometry of real recordings, read as the product reads them. Found by the environment variable
// PARKADE_SHARED_DATA or in ../shared/data beside the repository; skipped where absent.
#include "slam/odometry/estimate_trajectory.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "server/ingest/drive/open_drive_log.h"
#include "slam/evaluation/evaluate_trajectory.h"

namespace parkade {
namespace {

std::filesystem::path SharedData() {
  const char* folder = std::getenv("PARKADE_SHARED_DATA");
  return folder ? folder : "../shared/data";
}

struct Answer {
  OdometryResult odometry;
  TrajectoryEvaluation error;
};

Answer EstimateReal(const std::string& name, std::vector<double>* progress = nullptr) {
  const std::filesystem::path folder = SharedData() / name;
  OpenLogOptions open;
  if (std::filesystem::exists(folder / "rig")) open.rig_folder = folder / "rig";
  const auto log = OpenDriveLog(folder, open);
  Answer answer;
  answer.odometry = EstimateTrajectory(*log, {}, [&](double fraction) {
    if (progress) progress->push_back(fraction);
  });
  const std::vector<TimedPose> world_from_imu =
      PosesOf(ToTimedPoses(answer.odometry.odom_from_body), log->rig().body_from_imu);
  answer.error = EvaluateTrajectory(ReadTum(folder / "truth.tum"), world_from_imu);
  EXPECT_NEAR(answer.odometry.odom_from_body.span().Seconds(), log->span().Seconds(), 0.3);
  return answer;
}

#define SKIP_WITHOUT(name)                           \
  if (!std::filesystem::exists(SharedData() / name)) \
  GTEST_SKIP() << "no " << name << " in " << SharedData()

TEST(EstimateTrajectory, AStereoCarThatRollsFromTheFirstFrameDriftsLessThanOnePercent) {
  SKIP_WITHOUT("kitti_06_clip");

  std::vector<double> progress;
  const Answer answer = EstimateReal("kitti_06_clip", &progress);

  EXPECT_LT(answer.error.drift_percent, 1.0);
  EXPECT_NEAR(answer.error.scale, 1, 0.02);
  ASSERT_FALSE(progress.empty());
  EXPECT_TRUE(std::is_sorted(progress.begin(), progress.end()));
  EXPECT_EQ(progress.back(), 1.0);
}

TEST(EstimateTrajectory, ADroneInFlightIsFollowedFromTheFirstSample) {
  SKIP_WITHOUT("euroc_v101_moving");

  const Answer answer = EstimateReal("euroc_v101_moving");

  EXPECT_LT(answer.error.rigid.translation.rmse, 0.03);
}

TEST(EstimateTrajectory, ADroneOnTheGroundStays) {
  SKIP_WITHOUT("euroc_v101_clip");

  const Answer answer = EstimateReal("euroc_v101_clip");

  // Its motors run: the ground truth itself moves by 6 mm, and the IMU runs on for 0.4 s after the
  // last image.
  const auto& states = answer.odometry.odom_from_body.states();
  ASSERT_FALSE(states.empty());
  for (const TrajectoryState& state : states)
    ASSERT_LT(
        (state.world_from_body.translation - states.front().world_from_body.translation).norm(),
        0.02);
}

}  // namespace
}  // namespace parkade

#include "tests/bench/odometry_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace parkade {
namespace {

PlaceRun RunOf(std::vector<double> drifts) {
  PlaceRun run{"lot:1", "exact", 1, 50, std::move(drifts), {}};
  run.scale_percent.assign(run.drift_percent.size(), 0.1);
  return run;
}

simulator::TrackDrive ShortDrive(int noise_seed, const std::string& rig = "exact") {
  PlaceCase place = ParsePlace("lot:3", 10);
  place.drive.drive.cameras.rate = 5;
  place.drive.noise_seed = noise_seed;
  SetRigError(rig, place.drive);
  return simulator::MakeTrackDrive(place.drive);
}

TEST(OdometryPlaces, OtherNoiseLeavesThePathAsItIs) {
  const simulator::TrackDrive a = ShortDrive(1), b = ShortDrive(2, "1");

  ASSERT_EQ(a.truth.size(), b.truth.size());
  EXPECT_EQ(a.truth.back().world_from_frame.translation, b.truth.back().world_from_frame.translation);
  EXPECT_EQ(a.true_rig.cameras[2].body_from_camera.translation, b.true_rig.cameras[2].body_from_camera.translation);
  EXPECT_NE(a.imu[100].linear_acceleration, b.imu[100].linear_acceleration);
  EXPECT_NE(a.pictures[9].frame.observations[0].pixel, b.pictures[9].frame.observations[0].pixel);
  const Rigid3 off = b.true_rig.cameras[1].body_from_camera.Inverse() * b.rig.cameras[1].body_from_camera;
  EXPECT_NEAR(LogSo3(off.rotation).norm() * 180 / M_PI, 1, 1e-6);
}

TEST(OdometryPlaces, OneCameraSeesWhatItSawAmongTheOthers) {
  const simulator::TrackDrive all = ShortDrive(1), left = OneCamera(all, 1);

  const auto is_left = [](const simulator::SeenPicture& picture) { return picture.frame.camera == 1; };
  ASSERT_EQ(left.rig.cameras.size(), 1u);
  EXPECT_EQ(left.rig.cameras[0].name, all.rig.cameras[1].name);
  ASSERT_EQ(left.pictures.size(),
            static_cast<size_t>(std::count_if(all.pictures.begin(), all.pictures.end(), is_left)));
  const auto seen = std::find_if(all.pictures.begin(), all.pictures.end(), is_left);
  EXPECT_EQ(left.pictures[0].frame.camera, 0);
  EXPECT_EQ(left.pictures[0].frame.observations.size(), seen->frame.observations.size());
  for (const simulator::SeenPicture& picture : left.pictures) EXPECT_TRUE(picture.crossed.empty());
}

TEST(OdometryPlaces, TheBestCameraIsBestOverAllSeeds) {
  const PlaceSummary summary = SummarizePlace({RunOf({3, 4, 1}), RunOf({3, 4, 7}), RunOf({3, 4, 5})});

  EXPECT_EQ(summary.num_runs, 3u);
  EXPECT_EQ(summary.best, 1u);
  EXPECT_DOUBLE_EQ(summary.ratio, 0.75);
  EXPECT_DOUBLE_EQ(summary.rms_drift[2], 5);
  EXPECT_NEAR(summary.near_luckiest, 2.0 / 3, 1e-12);
  EXPECT_LE(summary.low, summary.ratio);
  EXPECT_GE(summary.high, summary.ratio);
}

TEST(OdometryPlaces, RunsSurviveTheirFile) {
  const PlaceRun run = RunOf({0.1, 0.2, 0.3, 0.4, kNoAnswer});

  const PlaceRun again = PlaceRunFromJson(nlohmann::json::parse(ToJson(run).dump()));

  EXPECT_EQ(again.place, run.place);
  EXPECT_EQ(again.rig, run.rig);
  EXPECT_EQ(again.noise_seed, run.noise_seed);
  EXPECT_EQ(again.drift_percent, run.drift_percent);
  EXPECT_EQ(again.scale_percent, run.scale_percent);
  EXPECT_NE(PlaceTable({run, again}).find("| lot:1 | exact | 2 | 0.100 | 0.200 |"), std::string::npos);
}

TEST(OdometryPlaces, RefusesWhatIsNoPlace) {
  EXPECT_THROW(ParsePlace("lot", 10), Error);
  EXPECT_THROW(ParsePlace("lot:x", 10), Error);
  EXPECT_THROW(ParsePlace("lot:1:flying", 10), Error);
  simulator::TrackDriveOptions drive;
  EXPECT_THROW(SetRigError("2", drive), Error);
}

}  // namespace
}  // namespace parkade

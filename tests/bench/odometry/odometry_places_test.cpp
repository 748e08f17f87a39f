#include "tests/bench/odometry/odometry_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace parkade {
namespace {

PlaceRun RunOf(std::vector<double> drifts) {
  PlaceRun run;
  run.place = "lot:1";
  run.rig = "exact";
  run.noise_seed = 1;
  run.length = 50;
  run.drift_percent = std::move(drifts);
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
  EXPECT_EQ(a.truth.back().world_from_frame.translation,
            b.truth.back().world_from_frame.translation);
  EXPECT_EQ(a.true_rig.cameras[2].body_from_camera.translation,
            b.true_rig.cameras[2].body_from_camera.translation);
  EXPECT_NE(a.imu[100].linear_acceleration, b.imu[100].linear_acceleration);
  EXPECT_NE(a.images[9].frame.observations[0].pixel, b.images[9].frame.observations[0].pixel);
  const Rigid3 off =
      b.true_rig.cameras[1].body_from_camera.Inverse() * b.rig.cameras[1].body_from_camera;
  EXPECT_NEAR(LogSo3(off.rotation).norm() * 180 / M_PI, 1, 1e-6);
}

TEST(OdometryPlaces, OneCameraSeesWhatItSawAmongTheOthers) {
  const simulator::TrackDrive all = ShortDrive(1), left = OneCamera(all, 1);

  const auto is_left = [](const simulator::SeenImage& image) { return image.frame.camera == 1; };
  ASSERT_EQ(left.rig.cameras.size(), 1u);
  EXPECT_EQ(left.rig.cameras[0].name, all.rig.cameras[1].name);
  ASSERT_EQ(left.images.size(),
            static_cast<size_t>(std::count_if(all.images.begin(), all.images.end(), is_left)));
  const auto seen = std::find_if(all.images.begin(), all.images.end(), is_left);
  EXPECT_EQ(left.images[0].frame.camera, 0);
  EXPECT_EQ(left.images[0].frame.observations.size(), seen->frame.observations.size());
  for (const simulator::SeenImage& image : left.images) EXPECT_TRUE(image.crossed.empty());
}

TEST(OdometryPlaces, TheBestCameraIsBestOverAllSeeds) {
  const PlaceSummary summary =
      SummarizePlace({RunOf({3, 4, 1}), RunOf({3, 4, 7}), RunOf({3, 4, 5})});

  EXPECT_EQ(summary.num_runs, 3u);
  EXPECT_EQ(summary.best, 1u);
  EXPECT_DOUBLE_EQ(summary.ratio, 0.75);
  EXPECT_DOUBLE_EQ(summary.rms_drift[2], 5);
  EXPECT_NEAR(summary.near_luckiest, 2.0 / 3, 1e-12);
  EXPECT_LE(summary.low, summary.ratio);
  EXPECT_GE(summary.high, summary.ratio);
}

TEST(OdometryPlaces, TheWholeDriveIsAdjustedBesideItsOdometry) {
  PlaceCase place = ParsePlace("lot:3", 10);
  place.drive.drive.cameras.rate = 5;

  const std::vector<PlaceRun> runs = RunPlace(place, "exact", 1, {{}, WholeDriveOptions()});

  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].estimator, PlaceRun::kOdometry);
  EXPECT_EQ(runs[1].estimator, PlaceRun::kWholeDrive);
  const size_t n = 5;
  for (const PlaceRun& run : runs) {
    ASSERT_EQ(run.drift_percent.size(), n);
    ASSERT_EQ(run.error_products.size(), n * n);
    for (size_t i = 0; i < n; ++i) {
      EXPECT_LT(run.drift_percent[i], 1) << run.estimator << " of estimate " << i;
      EXPECT_NEAR(std::sqrt(run.error_products[i * n + i]), run.drift_percent[i],
                  0.1 * run.drift_percent[i]);
      for (size_t j = 0; j < i; ++j)
        EXPECT_EQ(run.error_products[i * n + j], run.error_products[j * n + i]);
    }
  }
  EXPECT_NE(runs[0].drift_percent[0], runs[1].drift_percent[0]);
}

TEST(OdometryPlaces, EachEstimatorHasARowOfItsOwn) {
  PlaceRun adjusted = RunOf({1, 2, 3});
  adjusted.estimator = PlaceRun::kWholeDrive;

  const std::string table = PlaceTable({RunOf({4, 5, 6}), adjusted});

  EXPECT_NE(table.find("| lot:1 | exact | odometry | 1 | 4.000 | 5.000 |"), std::string::npos);
  EXPECT_NE(table.find("| lot:1 | exact | whole drive | 1 | 1.000 | 2.000 |"), std::string::npos);
}

TEST(OdometryPlaces, AnEstimateThatIgnoresABetterOneWantsIt) {
  PlaceRun independent = RunOf({2, 1}), optimal = RunOf({1, 2});
  independent.error_products = {4, 0, 0, 1};
  optimal.error_products = {1, 1, 1, 4};

  EXPECT_DOUBLE_EQ(SummarizePlace({independent}).wanted_share, 0.8);
  EXPECT_DOUBLE_EQ(SummarizePlace({optimal}).wanted_share, 0);
  EXPECT_DOUBLE_EQ(SummarizePlace({RunOf({1, 2})}).wanted_share, 0);
}

TEST(OdometryPlaces, RunsSurviveTheirFile) {
  PlaceRun run = RunOf({0.1, 0.2, 0.3, 0.4, kNoAnswer});
  run.estimator = PlaceRun::kWholeDrive;
  run.error_products = {0.01, 0.002};

  const PlaceRun again = PlaceRunFromJson(nlohmann::json::parse(ToJson(run).dump()));

  EXPECT_EQ(again.place, run.place);
  EXPECT_EQ(again.rig, run.rig);
  EXPECT_EQ(again.noise_seed, run.noise_seed);
  EXPECT_EQ(again.drift_percent, run.drift_percent);
  EXPECT_EQ(again.error_products, run.error_products);
  EXPECT_EQ(again.scale_percent, run.scale_percent);
  EXPECT_NE(PlaceTable({run, again}).find("| lot:1 | exact | whole drive | 2 | 0.100 | 0.200 |"),
            std::string::npos);
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

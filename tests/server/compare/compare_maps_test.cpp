#include "server/compare/compare_maps.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/trajectory.h"
#include "server/map_folder/stage_cache.h"
#include "server/map_folder/surface_file.h"
#include "slam/places/keyframe_bytes.h"
#include "tests/mapping/worlds/test_surfaces.h"
#include "tests/server/store/temporary_root.h"
#include "tests/slam/worlds/drive_world.h"
#include "tests/support/api_description.h"

namespace parkade {
namespace {

class CompareMapsTest : public testing::Test {
 protected:
  /// Makes two maps of one place, the second of which lies elsewhere in its own site.
  const Rigid3 to_from_from_{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
                             Eigen::Vector3d(12, -30, 1.5)};

  /// A map as `parkade map` leaves it, as far as it is compared: a lot of 20 m x 15 m with cars at
  /// `cars`, and drives along a curve through it, moved by `site_from_first`.
  MapReader MakeMap(const std::string& name, const std::vector<std::string>& drives,
                    const Rigid3& site_from_first, const std::vector<Eigen::Vector2d>& cars,
                    const std::string& datum = "null") {
    const std::filesystem::path folder = root_.path() / name;
    nlohmann::json report = {{"datum", nlohmann::json::parse(datum)},
                             {"drives", nlohmann::json::array()}};
    for (const std::string& drive : drives) {
      report["drives"].push_back({{"name", drive}});
      std::filesystem::create_directories(folder / drive);
      std::vector<TimedPose> poses;
      for (int i = 0; i < 200; ++i) {
        const Rigid3 pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.01 * i, Eigen::Vector3d::UnitZ())),
                          Eigen::Vector3d(5 + 0.05 * i, 5 + 4 * std::sin(0.02 * i), 0)};
        poses.push_back({TimestampFromSeconds(0.1 * i), site_from_first * pose});
      }
      WriteTum(poses, folder / drive / "trajectory.tum");
    }
    WriteFileAtomically(folder / "report.json", report.dump());
    WriteSurface(MakeLot(site_from_first, cars), folder / "surface.bin");
    return MapReader(folder);
  }

  static SurfaceMap MakeLot(const Rigid3& site_from_first,
                            const std::vector<Eigen::Vector2d>& cars) {
    const Rigid3 first_from_site = site_from_first.Inverse();
    SurfaceMap lot = MakeSurface(1200, 1200, 0.05,
                                 [&](double, double) { return site_from_first.translation.z(); });
    for (SurfaceCell& cell : lot.cells) cell.x -= 600, cell.y -= 900;
    std::erase_if(lot.cells, [&](SurfaceCell& cell) {
      const Eigen::Vector3d point =
          first_from_site * Eigen::Vector3d(0.05 * cell.x, 0.05 * cell.y, 0);
      for (const Eigen::Vector2d& car : cars)
        if ((point.head<2>() - car).cwiseAbs().maxCoeff() < 1) cell.free_belief = 0.02F;
      return point.x() < 0 || point.x() > 20 || point.y() < 0 || point.y() > 15;
    });
    return lot;
  }

  /// Stores what a drive through a world of points saw, as if the map had been made from it.
  void AddKeyframes(const std::string& map, const std::string& name, const Rigid3& site_from_world,
                    const WorldDrive& drive) {
    const std::filesystem::path folder = root_.path() / map / name;
    StageCache({}, root_.path() / map).Get(name + "/places.bin", KeyOf({name}), [&] {
      return EncodeKeyframes(drive.drive.keyframes);
    });
    // The IMU sits backwards, a meter above the axle.
    WriteFileAtomically(
        folder / "calibration.yaml",
        "vehicle:\n  T_imu_body: [[-1, 0, 0, 0.2], [0, -1, 0, 0], [0, 0, 1, -1], [0, 0, 0, 1]]\n");
    const Rigid3 imu_from_body{ExpSo3({0, 0, M_PI}), {0.2, 0, -1}};
    std::vector<TimedPose> poses;
    for (size_t i = 0; i < drive.world_from_keyframe.size(); ++i)
      poses.push_back({drive.drive.keyframes[i].time,
                       site_from_world * drive.world_from_keyframe[i] * imu_from_body.Inverse()});
    WriteTum(poses, folder / "trajectory.tum");
  }

  TemporaryRoot root_;
};

TEST_F(CompareMapsTest, AlignsThemByTheDrivesTheyShare) {
  const MapReader from = MakeMap("a", {"monday"}, {}, {{3, 12}});
  const MapReader to = MakeMap("b", {"monday", "tuesday"}, to_from_from_, {{16, 3}});
  const MapComparison comparison = CompareMaps(from, to);
  EXPECT_EQ(comparison.alignment.aligned_by, "drives");
  const Rigid3 error = comparison.alignment.to_from_from.Inverse() * to_from_from_;
  EXPECT_LT(error.translation.norm(), 1e-6);
  EXPECT_LT(LogSo3(error.rotation).norm(), 1e-6);
  EXPECT_EQ(comparison.added, std::vector<std::string>{"tuesday"});
  ASSERT_EQ(comparison.trajectories.size(), 1U);
  EXPECT_LT(comparison.trajectories[0].largest, 1e-6);

  ASSERT_EQ(comparison.ground.regions.size(), 2U);
  EXPECT_EQ(comparison.ground.regions[0].change, GroundChange::kFreed);
  EXPECT_EQ(comparison.ground.regions[1].change, GroundChange::kBlocked);
  const Eigen::Vector3d came = to_from_from_.Inverse() * comparison.ground.regions[1].center;
  EXPECT_LT((came.head<2>() - Eigen::Vector2d(16, 3)).norm(), 0.1);

  auto answer = nlohmann::json::parse(EncodeComparison(comparison));
  answer.update({{"site", "lot"}, {"from", 1}, {"to", 2}});
  answer["urls"] = {{"geojson", ""}, {"png", ""}, {"pgw", ""}};
  EXPECT_EQ(MismatchWith("Comparison", answer), "");
}

TEST_F(CompareMapsTest, AlignsThemByKeyframesWhereTheyShareNoDrive) {
  // GNSS is meters off.
  const std::string munich = R"({"latitude_deg": 48.1, "longitude_deg": 11.5, "altitude": 500})";
  const std::string nearby =
      R"({"latitude_deg": 48.10002, "longitude_deg": 11.50002, "altitude": 504})";
  const Rigid3 site_from_first{Eigen::Quaterniond::Identity(), {2, -1, -3}};
  const MapReader from = MakeMap("a", {"monday"}, {}, {{3, 12}}, munich);
  const MapReader to = MakeMap("b", {"tuesday"}, site_from_first, {{16, 3}}, nearby);
  EXPECT_EQ(CompareMaps(from, to).alignment.aligned_by, "datum");

  const DriveWorld world;
  AddKeyframes("a", "monday", {}, world.Drive(1));
  AddKeyframes("b", "tuesday", site_from_first, world.Drive(2, /*is_opposite=*/true));
  const MapComparison comparison = CompareMaps(from, to);
  EXPECT_EQ(comparison.alignment.aligned_by, "places");
  const Eigen::Vector3d middle(10, 7, 0);
  EXPECT_LT((comparison.alignment.to_from_from * middle - site_from_first * middle).norm(), 0.05);
  EXPECT_LT(comparison.alignment.horizontal_sigma, 0.05);
  EXPECT_GT(comparison.alignment.num_links, 10U);
  EXPECT_EQ(comparison.alignment.note, "");
  ASSERT_EQ(comparison.ground.regions.size(), 2U);
  EXPECT_EQ(comparison.ground.regions[0].change, GroundChange::kFreed);
  EXPECT_EQ(comparison.ground.regions[1].change, GroundChange::kBlocked);

  // Keyframes alone do as well.
  const MapReader of_no_keyframe = MakeMap("c", {"friday"}, site_from_first, {{16, 3}});
  AddKeyframes("c", "friday", site_from_first, world.Drive(3));
  EXPECT_EQ(CompareMaps(from, of_no_keyframe).alignment.aligned_by, "places");
}

TEST_F(CompareMapsTest, ReportsNothingThatTheDatumsMayHaveMade) {
  const std::string munich = R"({"latitude_deg": 48.1, "longitude_deg": 11.5, "altitude": 500})";
  const std::string nearby =
      R"({"latitude_deg": 48.10001, "longitude_deg": 11.50001, "altitude": 504})";
  const MapComparison comparison = CompareMaps(MakeMap("a", {"monday"}, {}, {{3, 12}}, munich),
                                               MakeMap("b", {"tuesday"}, {}, {{16, 3}}, nearby));
  EXPECT_EQ(comparison.alignment.aligned_by, "datum");
  EXPECT_TRUE(comparison.ground.regions.empty());
  EXPECT_GT(comparison.ground.UnchangedArea(), 250);
  EXPECT_NEAR(comparison.ground.height.median, 0, 1e-3);
  const auto json = nlohmann::json::parse(EncodeComparison(comparison));
  EXPECT_EQ(json.at("alignment").at("note").get<std::string>().substr(0, 41),
            "The two maps are not registered to each o");
  EXPECT_GT(json.at("alignment").at("height_sigma"), 5);
}

TEST_F(CompareMapsTest, AlignsThemOnEarthWhereTheyShareNoDrive) {
  const std::string munich = R"({"latitude_deg": 48.1, "longitude_deg": 11.5, "altitude": 500})";
  const std::string nearby =
      R"({"latitude_deg": 48.1, "longitude_deg": 11.50002, "altitude": 500})";
  const MapReader from = MakeMap("a", {"monday"}, {}, {}, munich);
  const MapReader to = MakeMap("b", {"tuesday"}, {}, {}, nearby);
  const MapComparison comparison = CompareMaps(from, to);
  EXPECT_EQ(comparison.alignment.aligned_by, "datum");
  EXPECT_NEAR(comparison.alignment.to_from_from.translation.x(), -1.49, 0.01);
  EXPECT_EQ(comparison.removed, std::vector<std::string>{"monday"});

  const MapReader far = MakeMap("c", {"friday"}, {}, {},
                                R"({"latitude_deg": 52, "longitude_deg": 11.5, "altitude": 0})");
  EXPECT_THROW(CompareMaps(from, far), Error);
  EXPECT_THROW(CompareMaps(from, MakeMap("d", {"sunday"}, {}, {})), Error)
      << "nothing says how they lie";
  const std::string of_no_height =
      R"({"latitude_deg": 48.1, "longitude_deg": 11.5, "altitude": 0, "is_altitude_known": false})";
  EXPECT_THROW(CompareMaps(from, MakeMap("e", {"sunday"}, {}, {}, of_no_height)), Error)
      << "500 m would be wrong";
}

TEST_F(CompareMapsTest, TwoLogsOfOneNameAreTwoDrives) {
  const MapReader from = MakeMap("a", {"drive"}, {}, {}),
                  to = MakeMap("b", {"drive"}, to_from_from_, {});
  EXPECT_EQ(CompareMaps(from, to).alignment.aligned_by, "drives");
  const auto with_log = [&](const char* map, const char* sha256) {
    nlohmann::json report = nlohmann::json::parse(ReadFile(root_.path() / map / "report.json"));
    report["drives"][0]["log"] = {{"name", "drive"}, {"sha256", sha256}};
    WriteFileAtomically(root_.path() / map / "report.json", report.dump());
    return MapReader(root_.path() / map);
  };
  EXPECT_EQ(CompareMaps(with_log("a", "12"), with_log("b", "12")).alignment.aligned_by, "drives");
  EXPECT_THROW(CompareMaps(with_log("a", "12"), with_log("b", "34")), Error)
      << "nothing says how they lie";
}

TEST_F(CompareMapsTest, LeavesItsFilesOrNothing) {
  const MapReader from = MakeMap("a", {"monday"}, {}, {{3, 12}});
  const MapReader to = MakeMap("b", {"monday"}, {}, {});
  WriteComparison(CompareMaps(from, to), root_.path() / "out");
  const auto json = nlohmann::json::parse(ReadFile(root_.path() / "out" / "changes.json"));
  EXPECT_NEAR(json.at("free_space").at("freed").get<double>(), 4, 0.2);
  EXPECT_EQ(json.at("free_space").at("lost"), 0);
  EXPECT_EQ(json.at("regions").at(0).at("change"), "freed");
  for (const char* file : {"changes.geojson", "changes.png", "changes.pgw"})
    EXPECT_TRUE(std::filesystem::exists(root_.path() / "out" / file)) << file;
}

TEST_F(CompareMapsTest, SayWhatIsMissing) {
  const MapReader map = MakeMap("a", {"monday"}, {}, {});
  std::filesystem::remove(root_.path() / "a" / "surface.bin");
  try {
    CompareMaps(map, map);
    FAIL() << "there was nothing to compare";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("has no surface.bin"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace parkade

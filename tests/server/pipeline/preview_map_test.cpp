#include "server/pipeline/preview_map.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "export/write_site_map.h"
#include "server/map_folder/stage_cache.h"
#include "slam/sessions/stage_results.h"
#include "tests/mapping/worlds/test_surfaces.h"
#include "tests/server/store/temporary_root.h"

namespace parkade {
namespace {

const Rigid3 kImuFromBody{ExpSo3({0, 0, 1}), {0.1, 0, -0.8}};

/// A drive along x over ground of 40 m x 10 m, both moved.
SiteMap MakeSite(const std::string& drive, const Rigid3& site_from_first) {
  SiteMap site;
  for (double x = 0; x < 40; x += 4) AddRectangle(site.mesh, x, -5, x + 4, 5, 0);
  site.mesh = Transformed(site.mesh, site_from_first);
  site.drives.emplace_back().name = drive;
  site.drives[0].rig.body_from_imu = kImuFromBody.Inverse();
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 400; ++i) {
    TrajectoryState& state = states.emplace_back();
    state.time = TimestampFromSeconds(0.1 * i);
    state.world_from_body = Rigid3{Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}};
  }
  site.drives[0].odometry = Trajectory(std::move(states));
  site.drives[0].site_from_body_trajectory = site.drives[0].odometry.Transformed(site_from_first);
  return site;
}

/// The box around the ground of a .glb, in site.
std::pair<Eigen::Vector3d, Eigen::Vector3d> BoundsOf(const std::string& glb) {
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, glb.data() + 12, sizeof bytes);
  const auto json = nlohmann::json::parse(glb.substr(20, bytes));
  std::pair<Eigen::Vector3d, Eigen::Vector3d> bounds;
  for (const auto& node : json.at("nodes")) {
    if (node.at("name") != "ground") continue;
    const size_t positions =
        json["meshes"][node["mesh"].get<size_t>()]["primitives"][0]["attributes"]["POSITION"];
    const auto corner = [&](const char* key) {
      Eigen::Vector3d point;
      for (size_t i = 0; i < 3; ++i)
        point[static_cast<Eigen::Index>(i)] =
            json["accessors"][positions][key][i].get<double>() +
            (node.contains("translation") ? node["translation"][i].get<double>() : 0);
      return Eigen::Vector3d(point.x(), -point.z(), point.y());
    };
    const Eigen::Vector3d low = corner("min"), high = corner("max");
    bounds = {low.cwiseMin(high), low.cwiseMax(high)};
  }
  return bounds;
}

class PreviewMapTest : public testing::Test {
 protected:
  PreviewMapTest() {
    WriteSiteMap(MakeSite("monday", {}), root_.path());
    WriteFileAtomically(root_.path() / "report.json",
                        R"({"datum": null, "drives": [{"name": "monday"}]})");
  }
  /// The preview of the drive, once `after` is believed where `before` was in the old map.
  std::optional<std::string> Joint(const std::vector<LoopEvidence>& before,
                                   const std::vector<LoopEvidence>& after,
                                   bool is_odometry_taken = true, const LogHashes& logs = {}) {
    LoopClosure old_loops, loops;
    const SiteMap site = MakeSite("monday", {});
    old_loops.odom_from_body = loops.odom_from_body = site.drives[0].odometry;
    old_loops.loops = before, loops.loops = after;
    std::filesystem::remove(root_.path() / "monday/loops.bin");
    StageCache({}, root_.path()).Get("monday/loops.bin", KeyOf({"loops"}), [&] {
      return EncodeLoops(old_loops);
    });
    const ClosedDrive drive{"monday", kImuFromBody.Inverse(), &site.drives[0].odometry, &loops,
                            is_odometry_taken};
    return EncodeJointPreview(root_.path(), logs, std::span(&drive, 1), LinkReview{},
                              LoopOptions{});
  }
  TemporaryRoot root_;
};

/// The end of the drive lies by so much to the left of where it began, as seen there.
LoopEvidence Loop(double left) {
  LoopEvidence loop;
  loop.id = "0-20", loop.earlier_keyframe = 0, loop.later_keyframe = 20, loop.weight = 1;
  loop.later = TimestampFromSeconds(40);
  loop.pose.a_from_b.translation = {40, left, 0};
  loop.pose.information = 1e6 * Matrix6d::Identity();
  return loop;
}

std::string PreviewIn(const std::string& glb) {
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, glb.data() + 12, sizeof bytes);
  return nlohmann::json::parse(glb.substr(20, bytes)).at("asset").at("extras").at("preview");
}

TEST_F(PreviewMapTest, ComesOnceAnotherLoopIsClosed) {
  const std::optional<std::string> preview = Joint({}, {Loop(0.5)});
  ASSERT_TRUE(preview);
  EXPECT_EQ(PreviewIn(*preview), "joint");
  const auto [low, high] = BoundsOf(*preview);
  EXPECT_NEAR(high.y(), 5.5, 0.05) << "the far end went to the left";
  EXPECT_NEAR(low.y(), -5, 0.05) << "the beginning stayed";
  EXPECT_EQ(PreviewIn(EncodePreview(root_.path(), {}, MakeSite("monday", {}))), "final");
}

TEST_F(PreviewMapTest, AWithdrawnLoopLetsGoOfTheDrive) {
  SiteMap bent = MakeSite("monday", {});  // as the loop had bent it; odometry was straight
  for (Eigen::Vector3f& vertex : bent.mesh.vertices)
    vertex.y() += 0.5F * std::pow(vertex.x() / 40, 2.0F);
  std::vector<TrajectoryState> states = bent.drives[0].odometry.states();
  for (TrajectoryState& state : states) {
    Eigen::Vector3d& at = state.world_from_body.translation;
    state.world_from_body.rotation = ExpSo3({0, 0, at.x() / 1600});
    at.y() = 0.5 * std::pow(at.x() / 40, 2);
  }
  bent.drives[0].site_from_body_trajectory = Trajectory(std::move(states));
  WriteSiteMap(bent, root_.path());

  const std::optional<std::string> preview = Joint({Loop(0.5)}, {});
  ASSERT_TRUE(preview);
  EXPECT_NEAR(BoundsOf(*preview).second.y(), 5, 0.05)
      << "as the odometry saw it, not as the loop had bent it";
}

TEST_F(PreviewMapTest, WaitsForTheFinalOneWhereNothingWasClosedAnew) {
  EXPECT_FALSE(Joint({Loop(0)}, {Loop(0)}));
  EXPECT_FALSE(Joint({}, {Loop(0.5)}, /*is_odometry_taken=*/false)) << "its places are others";
}

TEST_F(PreviewMapTest, DrivesOfOneNameAndOfTwoLogsAreTwo) {
  WriteFileAtomically(
      root_.path() / "report.json",
      R"({"datum": null, "drives": [{"name": "monday", "log": {"sha256": "one"}}]})");
  EXPECT_NO_THROW(EncodePreview(root_.path(), {{"monday", "one"}}, MakeSite("monday", {})));
  EXPECT_NO_THROW(EncodePreview(root_.path(), {}, MakeSite("monday", {}))) << "nobody says so";
  EXPECT_THROW(EncodePreview(root_.path(), {{"monday", "two"}}, MakeSite("monday", {})), Error);
  EXPECT_TRUE(Joint({}, {Loop(0.5)}, true, {{"monday", "one"}}));
  EXPECT_FALSE(Joint({}, {Loop(0.5)}, true, {{"monday", "two"}}));
}

TEST_F(PreviewMapTest, ShowsTheOldGroundWhereTheNewTrajectoriesPutIt) {
  const Rigid3 moved{ExpSo3({0, 0, M_PI / 2}), {100, 20, 3}};
  const auto [low, high] = BoundsOf(EncodePreview(root_.path(), {}, MakeSite("monday", moved)));
  EXPECT_LT((low - Eigen::Vector3d(95, 20, 3)).norm(), 1e-3) << low.transpose();
  EXPECT_LT((high - Eigen::Vector3d(105, 60, 3)).norm(), 1e-3) << high.transpose();
}

TEST_F(PreviewMapTest, LeavesOutWhatOnlyADriveSawThatLeft) {
  SiteMap site = MakeSite("monday", {});
  site.drives[0].site_from_body_trajectory = Trajectory([&] {
    std::vector<TrajectoryState> states = site.drives[0].site_from_body_trajectory.states();
    states.resize(151);  // until x = 15
    return states;
  }());
  EXPECT_NEAR(BoundsOf(EncodePreview(root_.path(), {}, site)).second.x(), 40, 1e-3)
      << "it has not left";
  WriteFileAtomically(root_.path() / "report.json",
                      R"({"datum": null, "drives": [{"name": "monday"}, {"name": "tuesday"}]})");
  const double end = BoundsOf(EncodePreview(root_.path(), {}, site)).second.x();
  EXPECT_GT(end, 23);
  EXPECT_LT(end, 33);
}

TEST_F(PreviewMapTest, SaysWhyThereIsNone) {
  EXPECT_THROW(EncodePreview(root_.path(), {}, MakeSite("tuesday", {})), Error)
      << "no drive in common";
  std::filesystem::remove(root_.path() / "ground.ply");
  EXPECT_THROW(EncodePreview(root_.path(), {}, MakeSite("monday", {})), Error);
}

}  // namespace
}  // namespace parkade

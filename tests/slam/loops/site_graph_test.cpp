#include "slam/loops/site_graph.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "slam/places/describe_keyframes.h"

namespace parkade {
namespace {

/// Along x at 1 m/s for 40 m, bent to the left by `bend` at its end.
Trajectory Drive(double bend = 0, double y = 0) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 400; ++i) {
    const double x = 0.1 * i, share = x / 40;
    TrajectoryState& state = states.emplace_back();
    state.time = TimestampFromSeconds(x);
    state.world_from_body = {ExpSo3({0, 0, 2 * bend * share / 40}),
                             {x, y + bend * share * share, 0}};
  }
  return Trajectory(std::move(states));
}

/// From the first place to the last of a drive of 40 m.
LoopEvidence Loop(const Rigid3& earlier_from_later, double sigma = 0.001) {
  LoopEvidence loop;
  loop.id = "0-20", loop.earlier_keyframe = 0, loop.later_keyframe = 20, loop.weight = 1;
  loop.pose.a_from_b = earlier_from_later;
  loop.pose.information = Matrix6d::Identity() / (sigma * sigma);
  return loop;
}

LoopClosure Closed(const Trajectory& odom_from_body, const std::vector<LoopEvidence>& loops) {
  LoopClosure closure;
  closure.odom_from_body = odom_from_body;
  closure.loops = loops;
  return closure;
}

Eigen::Vector3d EndOf(const SiteGraph& site, size_t drive = 0) {
  return site.graph.vertices[site.first_vertex[drive] + 20].world_from_vertex.translation;
}

double LargestMove(const SiteGraph& site) {
  double largest = 0;
  for (size_t i = 1; i < site.before.size(); ++i)
    largest = std::max(
        largest,
        (site.graph.vertices[i].world_from_vertex.translation - site.before[i].translation).norm());
  return largest;
}

TEST(RegraphSite, WithoutANewLoopTheDriveKeepsTheShapeOfItsRefinement) {
  const Rigid3 site_from_odom{ExpSo3({0, 0, 1}), {300, 20, 5}};
  const LoopEvidence loop = Loop({Eigen::Quaterniond::Identity(), {40, 0.3, 0}});
  const RevisitedDrive drive{Drive(0.5), Closed(Drive(0.4), {loop}), Closed(Drive(0.4), {loop}),
                             Drive(0.2).Transformed(site_from_odom)};
  EXPECT_FALSE(drive.HasChanged());
  const SiteGraph site = RegraphSite(std::span(&drive, 1), {}, {});
  EXPECT_EQ(site.graph.vertices.size(), 22u) << "the world and 21 places";
  EXPECT_LT(LargestMove(site), 1e-6);
}

TEST(RegraphSite, ANewLoopBendsTheRefinedDrive) {
  const RevisitedDrive drive{Drive(0.5), Closed(Drive(0.5), {}),
                             Closed(Drive(0), {Loop({Eigen::Quaterniond::Identity(), {40, 0, 0}})}),
                             Drive(0.2)};
  EXPECT_TRUE(drive.HasChanged());
  EXPECT_FALSE(drive.HasLost());
  const SiteGraph site = RegraphSite(std::span(&drive, 1), {}, {});
  EXPECT_LT((EndOf(site) - Eigen::Vector3d(40, 0, 0)).norm(), 0.005);
  EXPECT_LT((site.graph.vertices[1].world_from_vertex.translation).norm(), 1e-9)
      << "the first place is held";
}

TEST(RegraphSite, ADriveThatLostALoopHasTheShapeOfItsOdometry) {
  const RevisitedDrive drive{Drive(0.5),
                             Closed(Drive(0), {Loop({Eigen::Quaterniond::Identity(), {40, 0, 0}})}),
                             Closed(Drive(0.5), {}), Drive(0)};
  EXPECT_TRUE(drive.HasLost());
  EXPECT_LT((EndOf(RegraphSite(std::span(&drive, 1), {}, {})) - Eigen::Vector3d(40, 0.5, 0)).norm(),
            1e-6);
}

TEST(RegraphSite, LinksCarryOtherDrivesAlongAndWrongOnesAreLeftOut) {
  const LoopEvidence loop = Loop({Eigen::Quaterniond::Identity(), {40, 0.4, 0}});
  const RevisitedDrive drives[] = {
      {Drive(), Closed(Drive(), {}), Closed(Drive(0.4), {loop}), Drive()},
      {Drive(), Closed(Drive(), {}), Closed(Drive(), {}), Drive(0, 3)}};
  std::vector<KeptLink> links;
  for (size_t keyframe = 0; keyframe <= 20; keyframe += 4)
    links.push_back({0,
                     1,
                     keyframe,
                     keyframe,
                     {Eigen::Quaterniond::Identity(), {0, 3, 0}},
                     1e4 * Matrix6d::Identity()});
  links.push_back({0, 1, 3, 9, {ExpSo3({0, 0, 1}), {0, -2, 0}}, 1e4 * Matrix6d::Identity()});
  const SiteGraph site = RegraphSite(drives, links, {});
  EXPECT_EQ(site.num_links, 6);
  EXPECT_EQ(site.graph.edges.size(), 2u * (20 + 21 + 1) + 1 + 6)
      << "odometry, gravity, ends, the loop, links";
  EXPECT_LT((EndOf(site) - Eigen::Vector3d(40, 0.4, 0)).norm(), 0.02);
  EXPECT_LT((EndOf(site, 1) - Eigen::Vector3d(40, 3.4, 0)).norm(), 0.04);
}

TEST(RegraphSite, RefusesLinksToKeyframesThatAreNone) {
  const RevisitedDrive drive{Drive(), Closed(Drive(), {}), Closed(Drive(), {}), Drive()};
  const KeptLink link{0, 0, 3, 21, {}, Matrix6d::Identity()};
  EXPECT_THROW(RegraphSite(std::span(&drive, 1), std::span(&link, 1), {}), Error);
  EXPECT_THROW(RegraphSite({}, {}, {}), Error);
}

}  // namespace
}  // namespace parkade

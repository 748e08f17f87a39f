#include "mapping/mesh/deform_mesh.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "mapping/ground/cell_finder.h"
#include "mapping/mesh/mesh_surface.h"
#include "tests/mapping/worlds/deformed_mesh.h"
#include "tests/mapping/worlds/fuse_patches.h"
#include "tests/mapping/worlds/synthetic_drive.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

Rigid3 PoseAt(double x, double y, double z = 0, double yaw = 0) {
  return {ExpSo3({0, 0, yaw}), {x, y, z}};
}

DeformationGraph RandomGraph() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  DeformationGraph graph;
  for (int i = 0; i < 2; ++i)
    graph.nodes.push_back({3 * vector(), {ExpSo3(0.4 * vector()), 3 * vector()}});
  return graph;
}

/// The residual's change where a node is turned and shifted by a little, both ways.
template <typename Evaluate>
DeformationBlock Differences(DeformationGraph graph, size_t node, const Evaluate& evaluate) {
  constexpr double kStep = 1e-6;
  DeformationBlock block;
  const Rigid3 motion = graph.nodes[node].motion;
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix<double, 6, 1> ends[2];
    for (int side = 0; side < 2; ++side) {
      Eigen::Matrix<double, 6, 1> step = Eigen::Matrix<double, 6, 1>::Zero();
      step[i] = side == 0 ? kStep : -kStep;
      graph.nodes[node].motion = {ExpSo3(step.head<3>()) * motion.rotation,
                                  motion.translation + step.tail<3>()};
      ends[side] = evaluate(graph).residual;
    }
    block.col(i) = (ends[0] - ends[1]) / (2 * kStep);
  }
  return block;
}

TEST(DeformationGraph, JacobiansMatchFiniteDifferences) {
  const DeformationGraph graph = RandomGraph();
  const DeformationEdge edge{0, 1, 0.02, 0.01};
  const auto by_edge = [&](const DeformationGraph& at) { return EvaluateEdge(at, edge); };
  EXPECT_LT((EvaluateEdge(graph, edge).by_first - Differences(graph, 0, by_edge)).norm(), 1e-4);
  EXPECT_LT((EvaluateEdge(graph, edge).by_second - Differences(graph, 1, by_edge)).norm(), 1e-4);
  const DeformationAnchor anchor{1, PoseAt(1, 2, 3, 0.3), 0.02, 0.01};
  const auto by_anchor = [&](const DeformationGraph& at) { return EvaluateAnchor(at, anchor); };
  EXPECT_LT((EvaluateAnchor(graph, anchor).by_first - Differences(graph, 1, by_anchor)).norm(),
            1e-4);
}

/// Any symmetric matrix with these eigenvalues at least.
DeformationBlock Information(std::uint32_t seed, double least) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const DeformationBlock root = DeformationBlock::NullaryExpr([&] { return normal(random); });
  return root.transpose() * root + least * DeformationBlock::Identity();
}

TEST(DeformationGraph, JacobiansOfMeasurementsMatchFiniteDifferences) {
  DeformationGraph graph = RandomGraph();
  for (DeformationNode& node : graph.nodes) node.attitude = ExpSo3(0.5 * node.rest);
  for (const std::optional<size_t>& from : {std::optional<size_t>(0), std::optional<size_t>()}) {
    const DeformationMeasurement measurement{from, 1, PoseAt(1, -2, 0.5, 1.2), Information(5, 0.1)};
    const auto evaluate = [&](const DeformationGraph& at) {
      return EvaluateMeasurement(at, measurement);
    };
    const DeformationFactor factor = EvaluateMeasurement(graph, measurement);
    EXPECT_GT(factor.residual.norm(), 1) << "far from what was measured";
    EXPECT_LT((factor.by_first - Differences(graph, 0, evaluate)).norm(), 1e-4);
    EXPECT_LT((factor.by_second - Differences(graph, 1, evaluate)).norm(), 1e-4);
    const Rigid3 pose =
        from ? graph.nodes[0].Pose().Inverse() * graph.nodes[1].Pose() : graph.nodes[1].Pose();
    EXPECT_LT(EvaluateMeasurement(graph, {from, 1, pose, measurement.information}).residual.norm(),
              1e-9);
  }
}

TEST(DeformationGraph, TheSolutionIsAMinimumInEveryDirection) {
  DeformationGraph graph;
  for (int i = 0; i < 4; ++i) {
    const Rigid3 pose = PoseAt(3 * i, 0.2 * i * i, 0, 0.1 * i);
    graph.nodes.push_back(
        {pose.translation, {Eigen::Quaterniond::Identity(), pose.translation}, pose.rotation});
    if (i > 0)
      graph.measurements.push_back({static_cast<size_t>(i - 1), static_cast<size_t>(i),
                                    PoseAt(3, 0, 0, 0.2),
                                    Information(static_cast<std::uint32_t>(i), 50)});
  }
  graph.measurements.push_back({0, 3, PoseAt(8, 3, 0.3, 0.4), Information(9, 20)});
  graph.measurements.push_back({std::nullopt, 0, PoseAt(0.1, 0, 0, 0.05), Information(10, 20)});
  graph.edges.push_back({1, 2, 0.2, 0.1});
  const double before = CostOf(graph);
  EXPECT_LT(SolveDeformation(graph, 50), 50);
  const double cost = CostOf(graph);
  EXPECT_LT(cost, 0.5 * before);
  for (size_t node = 0; node < graph.nodes.size(); ++node)
    for (int i = 0; i < 6; ++i)
      for (const double step : {-1e-3, 1e-3}) {
        DeformationGraph moved = graph;
        Rigid3& motion = moved.nodes[node].motion;
        if (i < 3)
          motion.translation[i] += step;
        else
          motion.rotation = ExpSo3(step * Eigen::Vector3d::Unit(i - 3)) * motion.rotation;
        EXPECT_GT(CostOf(moved), cost) << "node " << node << ", direction " << i;
      }
}

/// Ground of 40 m x 10 m around a drive along x.
TriangleMesh Strip(double z = 0) {
  TriangleMesh mesh;
  for (double x = 0; x < 40; x += 4) AddRectangle(mesh, x, -5, x + 4, 5, z);
  return mesh;
}

std::vector<MovedKeyframe> Keyframes(double z, const std::function<Rigid3(const Rigid3&)>& move) {
  std::vector<MovedKeyframe> keyframes;
  for (double x = 0; x <= 40; x += 1) keyframes.push_back({PoseAt(x, 0, z), move(PoseAt(x, 0, z))});
  return keyframes;
}

TEST(DeformMesh, ARigidMotionIsReproducedExactly) {
  const Rigid3 motion{ExpSo3({0.02, -0.05, 2.5}), {3000, -800, 20}};
  const TriangleMesh mesh = Strip();
  const auto keyframes = Keyframes(0, [&](const Rigid3& pose) { return motion * pose; });
  const TriangleMesh moved = Deformed(mesh, DeformGround(mesh, keyframes));
  ValidateMesh(moved);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d truth = motion * mesh.vertices[i].cast<double>();
    EXPECT_LT((moved.origin + moved.vertices[i].cast<double>() - truth).norm(), 1e-5);
    EXPECT_LT(
        (moved.normals[i].cast<double>() - motion.rotation * mesh.normals[i].cast<double>()).norm(),
        1e-5);
  }
}

TEST(DeformMesh, DecksDoNotPullEachOther) {
  TriangleMesh mesh = Strip();
  const TriangleMesh upper = Strip(2.6);
  const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), upper.vertices.begin(), upper.vertices.end());
  mesh.normals.insert(mesh.normals.end(), upper.normals.begin(), upper.normals.end());
  for (const auto& [a, b, c] : upper.triangles)
    mesh.triangles.push_back({a + count, b + count, c + count});
  auto keyframes = Keyframes(0, [](const Rigid3& pose) { return pose; });
  const auto above = Keyframes(2.6, [](const Rigid3& pose) { return PoseAt(0, 1, 0.2) * pose; });
  keyframes.insert(keyframes.end(), above.begin(), above.end());
  const TriangleMesh moved = Deformed(mesh, DeformGround(mesh, keyframes));
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d shift =
        moved.origin + (moved.vertices[i] - mesh.vertices[i]).cast<double>();
    EXPECT_LT((shift - (i < count ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(0, 1, 0.2))).norm(),
              1e-4);
  }
}

TEST(DeformMesh, GroundBetweenDrivesThatPartIsStretched) {
  TriangleMesh mesh;
  for (double x = 0; x < 40; x += 4) AddRectangle(mesh, x, -5, x + 4, 25, 0);
  std::vector<MovedKeyframe> keyframes = Keyframes(0, [](const Rigid3& pose) { return pose; });
  for (double x = 0; x <= 40; x += 1) keyframes.push_back({PoseAt(x, 20), PoseAt(x, 20.4)});
  const MeshDeformation deformation = DeformGround(mesh, keyframes);
  EXPECT_NEAR(deformation.Apply({20, 0, 0}).y(), 0, 0.03);
  EXPECT_NEAR(deformation.Apply({20, 20, 0}).y(), 20.4, 0.03);
  const double between = deformation.Apply({20, 10, 0}).y();
  EXPECT_GT(between, 10.1);
  EXPECT_LT(between, 10.3);
}

TEST(DeformMesh, KnowsWhichGroundKeyframesSaw) {
  TriangleMesh mesh;
  for (double x = 0; x < 80; x += 4) AddRectangle(mesh, x, -5, x + 4, 5, 0);
  const auto keyframes = Keyframes(0, [](const Rigid3& pose) { return pose; });  // until x = 40
  const MeshDeformation deformation = DeformGround(mesh, keyframes);
  EXPECT_TRUE(deformation.IsSeen({30, 4, 0}));
  EXPECT_TRUE(deformation.IsSeen({48, 0, 0}));
  EXPECT_FALSE(deformation.IsSeen({56, 0, 0}));
  EXPECT_LT((deformation.Apply({70, 0, 0}) - Eigen::Vector3d(70, 0, 0)).norm(), 1e-4)
      << "its neighbors hold it";
}

TEST(DeformMesh, NothingSaysHowGroundMovesWithoutKeyframes) {
  EXPECT_THROW(DeformGround(Strip(), {}), Error);
  const std::vector<FreeKeyframe> new_ones = {{std::nullopt, PoseAt(1, 0)}};
  EXPECT_THROW(DeformJointly(Strip(), new_ones, {}), Error);
}

DeformationBlock Sigmas(double translation, double turn) {
  Eigen::Matrix<double, 6, 1> variances;
  variances << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(turn * turn);
  return variances.cwiseInverse().asDiagonal();
}

/// A chain of keyframes as they were, along x, each measured in the one before it; the first is
/// held.
void AddChain(double y, std::vector<FreeKeyframe>& keyframes,
              std::vector<DeformationMeasurement>& measurements) {
  for (int i = 0; i <= 20; ++i) {
    const size_t index = keyframes.size();
    keyframes.push_back({PoseAt(2 * i, y), PoseAt(2 * i, y), i == 0});
    if (i > 0) measurements.push_back({index - 1, index, PoseAt(2, 0), Sigmas(0.01, 0.005)});
  }
}

TEST(DeformJointly, ALoopMovesKeyframesAndTheirGround) {
  std::vector<FreeKeyframe> keyframes;
  std::vector<DeformationMeasurement> measurements;
  AddChain(0, keyframes, measurements);
  const JointDeformation still = DeformJointly(Strip(), keyframes, measurements);
  EXPECT_LT((still.to_from_body[20].translation - Eigen::Vector3d(40, 0, 0)).norm(), 1e-6);
  measurements.push_back({0, 20, PoseAt(40, 0.5), Sigmas(0.005, 0.002)});

  const JointDeformation joint = DeformJointly(Strip(), keyframes, measurements);

  EXPECT_NEAR(joint.to_from_body[20].translation.y(), 0.5, 0.02);
  const double middle = joint.to_from_body[10].translation.y();
  EXPECT_GT(middle, 0.1);
  EXPECT_LT(middle, 0.4);
  for (const size_t i : {size_t{2}, size_t{10}, size_t{18}}) {
    const Eigen::Vector3d ground = joint.ground.Apply({2.0 * static_cast<double>(i), 0, 0});
    EXPECT_LT((ground - joint.to_from_body[i].translation).norm(), 0.02) << i;
  }
}

TEST(DeformJointly, GroundTellsADriveThatNothingElseTies) {
  std::vector<FreeKeyframe> keyframes;
  std::vector<DeformationMeasurement> measurements;
  AddChain(-2, keyframes, measurements);
  keyframes.front().is_held = false;
  measurements.push_back(
      {std::nullopt, 0, PoseAt(0, -1.6), Sigmas(0.001, 0.001)});  // moved by 0.4 m to the side
  const size_t other = keyframes.size();
  AddChain(2, keyframes, measurements);
  keyframes[other].is_held = false;
  const JointDeformation joint = DeformJointly(Strip(), keyframes, measurements);
  for (const size_t i : {size_t{0}, size_t{10}, size_t{20}}) {
    EXPECT_NEAR(joint.to_from_body[i].translation.y(), -1.6, 0.02);
    EXPECT_NEAR(joint.to_from_body[other + i].translation.y(), 2.4, 0.02) << "over the same ground";
  }
}

TEST(DeformJointly, ANewKeyframeHoldsNoGround) {
  std::vector<FreeKeyframe> keyframes;
  std::vector<DeformationMeasurement> measurements;
  AddChain(0, keyframes, measurements);
  keyframes.push_back({std::nullopt, PoseAt(10, 3)});
  measurements.push_back({5, keyframes.size() - 1, PoseAt(0, 2.5), Sigmas(0.01, 0.01)});
  const JointDeformation joint = DeformJointly(Strip(), keyframes, measurements);
  EXPECT_NEAR(joint.to_from_body.back().translation.y(), 2.5, 1e-3);
  EXPECT_LT((joint.ground.Apply({10, 3, 0}) - Eigen::Vector3d(10, 3, 0)).norm(), 1e-3);
}

/// What one keyframe a meter sees: ground ahead and to both sides, striped across.
std::vector<GroundPatch> PatchesAlong(const std::vector<Rigid3>& poses) {
  std::vector<GroundPatch> patches;
  for (size_t i = 0; i < poses.size(); ++i) {
    GroundPatch& patch = patches.emplace_back();
    patch.time = TimestampFromSeconds(static_cast<double>(i));
    for (double x = 0.025; x < 8; x += 0.05)
      for (double y = -3.975; y < 4; y += 0.05)
        patch.samples.push_back(
            GroundSample{.point_in_body = Eigen::Vector3f(Eigen::Vector3d(x, y, 0).cast<float>()),
                         .blue = 100,
                         .green = 100,
                         .red = 100,
                         .is_free = true,
                         .weight = 1000});
  }
  return patches;
}

SurfaceMap Fuse(const std::vector<Rigid3>& poses) {
  std::vector<PosedGroundPatch> posed;
  std::vector<TrajectoryState> states;
  const std::vector<GroundPatch> patches = PatchesAlong(poses);
  for (size_t i = 0; i < poses.size(); ++i) {
    posed.push_back({patches[i], poses[i]});
    states.push_back({.time = patches[i].time, .world_from_body = poses[i]});
  }
  const DrivenPath path = MakeDrivenPath(0, MakeTestRig(), Trajectory(std::move(states)), Rigid3{});
  SurfaceOptions options;
  options.outlines = "observations";  // of a ground without anything around it a network says one
                                      // thing here, another there
  return FuseSurface(posed, std::span(&path, 1), options);
}

/// [m] from each point of one outline to the other, in order of size.
std::vector<double> OutlineDistances(const TriangleMesh& from, const TriangleMesh& to) {
  const auto outline = [](const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& [a, b, c] : mesh.triangles)
      for (const auto& edge : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)})
        ++edges[edge];
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> rim;
    for (const auto& [edge, count] : edges)
      if (count == 1)
        rim.emplace_back(mesh.origin + mesh.vertices[edge.first].cast<double>(),
                         mesh.origin + mesh.vertices[edge.second].cast<double>());
    return rim;
  };
  std::vector<double> distances;
  const auto target = outline(to);
  for (const auto& [point, end] : outline(from)) {
    double nearest = 1e9;
    for (const auto& [a, b] : target) {
      const double share = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + share * (b - a) - point).norm());
    }
    distances.push_back(nearest);
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

TEST(DeformMesh, ABentDriveBendsTheGroundAsFusingItAnewWould) {
  std::vector<Rigid3> before, after;
  std::vector<MovedKeyframe> keyframes;
  for (int i = 0; i <= 30; ++i) {
    before.push_back(PoseAt(i, 0));
    const double bend = 0.5 / (30 * 30);  // half a meter to the side at the end, 15 cm up
    after.push_back(PoseAt(i, bend * i * i, 0.005 * i, 2 * bend * i));
    after.back().rotation = after.back().rotation * ExpSo3({0, -0.005, 0});
    keyframes.push_back({before.back(), after.back()});
  }
  MeshOptions options;
  options.simplify = false;
  const TriangleMesh old_mesh = MeshSurface(Fuse(before), options);
  const SurfaceMap fused = Fuse(after);
  const TriangleMesh new_mesh = MeshSurface(fused, options),
                     preview = Deformed(old_mesh, DeformGround(old_mesh, keyframes));

  const CellFinder cells(fused);
  double sum = 0, worst = 0;
  size_t num_found = 0;
  for (const Eigen::Vector3f& vertex : preview.vertices) {
    const Eigen::Vector3d point = preview.origin + vertex.cast<double>();
    const SurfaceCell* cell = cells.Find(point);
    if (cell == nullptr) continue;
    const double error = std::abs(static_cast<double>(cell->height) - point.z());
    sum += error * error, worst = std::max(worst, error), ++num_found;
  }
  EXPECT_GT(num_found, preview.vertices.size() * 99 / 100);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(num_found)), 0.01);
  EXPECT_LT(worst, 0.02);
  const std::vector<double> rim = OutlineDistances(preview, new_mesh);
  EXPECT_LT(rim[rim.size() / 2], 0.02);
  EXPECT_LT(rim[rim.size() * 95 / 100], 0.05) << "a cell";
}

}  // namespace
}  // namespace parkade

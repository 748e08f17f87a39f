#include "slam/sessions/random_walk_modes.h"

#include <ceres/problem.h>

#include "slam/factors/relative_pose_cost.h"
#include "slam/loops/keyframe_graph.h"
#include "slam/refinement/marginal_covariance.h"

namespace parkade {
namespace {

constexpr size_t kMaxPoses = 60;

}  // namespace

CovarianceModes RandomWalkModes(const DriveToJoin& drive, const LoopOptions& options) {
  PoseGraph graph = WorldGraph();
  std::vector<Rigid3> poses;
  for (const RigKeyframe& keyframe : drive.keyframes) poses.push_back(keyframe.odom_from_keyframe);
  const size_t first = AddKeyframes(drive.keyframes, poses, options, 0, graph);
  AddClosedLoops(drive, first, graph);
  std::vector<std::array<double, kPoseSize>> values(graph.vertices.size());
  for (size_t i = 0; i < values.size(); ++i)
    PoseToParameters(graph.vertices[i].world_from_vertex, values[i].data());
  PoseManifold manifold;
  ceres::Problem::Options no_manifold;
  no_manifold.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(no_manifold);
  for (auto& pose : values) problem.AddParameterBlock(pose.data(), kPoseSize, &manifold);
  problem.SetParameterBlockConstant(values[0].data());
  problem.SetParameterBlockConstant(values[first].data());
  for (const PoseGraphEdge& edge : graph.edges)
    if (edge.from != 0 || edge.to != first)
      problem.AddResidualBlock(
          new RelativePoseCost(edge.from_from_to,
                               SquareRootWeight(graph, edge, PoseGraphObjective::kInformation)),
          nullptr, values[edge.from].data(), values[edge.to].data());

  const size_t every = (drive.keyframes.size() + kMaxPoses - 1) / kMaxPoses;
  std::vector<const double*> blocks;
  std::vector<size_t> chosen;
  for (size_t i = every; i < drive.keyframes.size(); i += every) {
    blocks.push_back(values[first + i].data());
    chosen.push_back(i);
  }
  std::vector<Timestamp> times = {drive.keyframes.front().time};
  const auto count = 6 * static_cast<Eigen::Index>(chosen.size() + 1);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  // Each keyframe is held by the one before.
  if (!blocks.empty())
    covariance.bottomRightCorner(count - 6, count - 6) =
        MarginalCovariance(problem, {}, blocks).value();
  for (size_t i = 0; i < chosen.size(); ++i) {
    times.push_back(drive.keyframes[chosen[i]].time);
    const Eigen::Matrix3d turn = poses[chosen[i]].rotation.toRotationMatrix();
    const auto at = 6 * static_cast<Eigen::Index>(i + 1);
    covariance.middleRows<3>(at) = (turn * covariance.middleRows<3>(at)).eval();
    covariance.middleCols<3>(at) = (covariance.middleCols<3>(at) * turn.transpose()).eval();
  }
  return FindCovarianceModes(std::move(times), covariance);
}

}  // namespace parkade

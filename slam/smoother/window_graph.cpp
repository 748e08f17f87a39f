#include "slam/smoother/window_graph.h"

#include <algorithm>

#include "slam/factors/measurement_model.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

/// 1 / this share of the diagonal is added: enough for landmarks at infinity, and little enough for
/// four iterations to move what only the sum of all measurements tells, as scale on a straight
/// road.
constexpr double kTrustRegion = 1e7;

size_t NumValues(const SmootherWindow& window) {
  return window.nodes.size() * (kPoseSize + kMotionSize) + 1 +
         window.cameras.size() * (kPoseSize + kTimingSize) + window.tracks.size() * kLandmarkSize;
}

}  // namespace

WindowGraph::WindowGraph(SmootherWindow& window)
    : window_(window), arena_(NumValues(window)), graph_(arena_, 1 / kCommonErrors) {
  AddStates();
  PointViewsAtBlocks();
  AddPriorAndIntervals();
  AddLandmarks();
}

void WindowGraph::AddStates() {
  // Motions first: each is tied to few other states, and they are eliminated in this order.
  for (const StateNode& node : window_.nodes)
    nodes_.emplace_back().motion = arena_.Add(node.motion);
  for (size_t i = 0; i < nodes_.size(); ++i) nodes_[i].pose = arena_.Add(window_.nodes[i].pose);
  for (const NodeBlocks& blocks : nodes_) {
    graph_.AddPose(blocks.pose, true);
    graph_.AddMotion(blocks.motion, true);
  }
  wheel_scale_ = arena_.Add(std::array<double, 1>{window_.wheel_scale});
  graph_.AddWheelScale(wheel_scale_, true);
  for (size_t i = 0; i < window_.cameras.size(); ++i) {
    CameraBlocks& blocks = cameras_.emplace_back();
    blocks.extrinsics = arena_.Add(window_.cameras[i].extrinsics);
    blocks.timing = arena_.Add(window_.cameras[i].timing);
    const auto number = static_cast<std::int64_t>(i);
    graph_.AddCamera(blocks, window_.IsEstimated({Kind::kExtrinsics, number}),
                     window_.IsEstimated({Kind::kTiming, number}));
  }
}

double* WindowGraph::BlockOf(const StateName& name) const {
  const auto camera = static_cast<size_t>(name.number);
  switch (name.kind) {
    case Kind::kPose: return NodeNumbered(name.number).pose;
    case Kind::kMotion: return NodeNumbered(name.number).motion;
    case Kind::kExtrinsics: return cameras_[camera].extrinsics;
    case Kind::kTiming: return cameras_[camera].timing;
    case Kind::kWheelScale: break;
  }
  return wheel_scale_;
}

void WindowGraph::PointViewsAtBlocks() {
  for (WindowView& view : window_.views) {
    ImageView& geometry = view.geometry;
    geometry.first_pose = NodeNumbered(view.first_node).pose;
    if (view.second_node) geometry.second_pose = NodeNumbered(*view.second_node).pose;
    geometry.extrinsics = cameras_[static_cast<size_t>(view.camera)].extrinsics;
    geometry.timing = cameras_[static_cast<size_t>(view.camera)].timing;
  }
}

void WindowGraph::AddPriorAndIntervals() {
  std::vector<double*> prior_blocks;
  for (const PriorBlock& block : window_.prior.blocks) prior_blocks.push_back(BlockOf(block.name));
  graph_.AddPrior(window_.prior, prior_blocks);
  for (size_t j = 1; j < nodes_.size(); ++j) {
    const NodeInterval& interval = *window_.nodes[j].interval;
    graph_.AddImu(interval.imu, nodes_[j - 1], nodes_[j]);
    if (interval.wheels) graph_.AddWheels(*interval.wheels, nodes_[j - 1], nodes_[j], wheel_scale_);
    if (interval.is_still) graph_.AddStandstill(nodes_[j - 1], nodes_[j]);
  }
}

void WindowGraph::AddLandmarks() {
  for (auto& [number, track] : window_.tracks) {
    if (!track.has_landmark) continue;
    double* landmark = arena_.Add(track.landmark);
    landmarks_.emplace_back(&track, landmark);
    graph_.AddLandmark(landmark);
    for (const TrackObservation& seen : track.observations)
      graph_.AddBearing(*seen.cost, seen.view->geometry, landmark);
  }
}

SolveSummary WindowGraph::Solve(int max_iterations) {
  GraphSolverOptions options;
  options.max_iterations = max_iterations;
  options.function_tolerance = 1e-4;
  options.trust_region = kTrustRegion;
  const SolveSummary summary = graph_.Solve(options);
  for (size_t i = 0; i < nodes_.size(); ++i) {
    std::copy_n(nodes_[i].pose, kPoseSize, window_.nodes[i].pose.begin());
    std::copy_n(nodes_[i].motion, kMotionSize, window_.nodes[i].motion.begin());
  }
  window_.wheel_scale = *wheel_scale_;
  for (size_t i = 0; i < cameras_.size(); ++i) {
    std::copy_n(cameras_[i].extrinsics, kPoseSize, window_.cameras[i].extrinsics.begin());
    std::copy_n(cameras_[i].timing, kTimingSize, window_.cameras[i].timing.begin());
  }
  for (const auto& [track, values] : landmarks_)
    std::copy_n(values, kLandmarkSize, track->landmark.begin());
  return summary;
}

}  // namespace parkade

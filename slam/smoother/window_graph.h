#pragma once

#include <utility>
#include <vector>

#include "slam/factors/factor_graph.h"
#include "slam/smoother/smoother_window.h"

namespace parkade {

/// The window as a factor graph, over copies of its states. The window's views look at these copies
/// as long as the graph lives.
class WindowGraph {
 public:
  explicit WindowGraph(SmootherWindow& window);
  ~WindowGraph() { window_.PointViewsAtNodes(); }
  WindowGraph(const WindowGraph&) = delete;
  WindowGraph& operator=(const WindowGraph&) = delete;

  double Cost() { return graph_.Cost(); }
  /// Moves the window's states to the optimum.
  SolveSummary Solve(int max_iterations);

 private:
  void AddStates();
  void PointViewsAtBlocks();
  void AddPriorAndIntervals();
  void AddLandmarks();
  const NodeBlocks& NodeNumbered(std::int64_t number) const {
    return nodes_[static_cast<size_t>(number - window_.nodes.front().number)];
  }
  double* BlockOf(const StateName& name) const;

  SmootherWindow& window_;
  ParameterArena arena_;
  FactorGraph graph_;
  std::vector<NodeBlocks> nodes_;
  std::vector<CameraBlocks> cameras_;
  double* wheel_scale_ = nullptr;
  std::vector<std::pair<Track*, double*>> landmarks_;
};

}  // namespace parkade

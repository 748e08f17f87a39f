#include "slam/smoother/marginalize_oldest.h"

#include <ceres/loss_function.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "slam/factors/imu_cost.h"
#include "slam/factors/imu_sensitivity.h"
#include "slam/factors/measurement_model.h"
#include "slam/factors/standstill_cost.h"
#include "slam/factors/wheel_cost.h"
#include "slam/smoother/marginalizer.h"
#include "slam/smoother/window_landmarks.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

constexpr StateName kWheelScale{Kind::kWheelScale, 0};

constexpr double kMinRoot = 1e-9;  // of a diagonal of the prior: nothing is known of a direction

/// Where each state's tangent begins among the columns.
class ColumnMap {
 public:
  explicit ColumnMap(const std::set<StateName>& states) {
    for (const StateName& name : states) {
      columns_[name] = width_;
      width_ += name.TangentSize();
    }
  }
  int operator[](const StateName& name) const { return columns_.at(name); }
  int width() const { return width_; }

 private:
  std::map<StateName, int> columns_;
  int width_ = 0;
};

/// Columns of the system, one per column of the block's tangents.
std::vector<int> ColumnsOf(const LinearizableBlock& block) {
  std::vector<int> columns;
  for (size_t i = 0; i < block.columns.size(); ++i)
    for (int k = 0; k < block.tangent_sizes[i]; ++k) columns.push_back(block.columns[i] + k);
  return columns;
}

/// All factors that hang on the oldest node, and the states that they speak of: those of the oldest
/// node first.
class OldestSystem {
 public:
  static constexpr int kDropped = kPoseTangentSize + kMotionSize;

  explicit OldestSystem(SmootherWindow& window)
      : window_(window),
        interval_(*window.nodes[1].interval),
        pose_i_{Kind::kPose, window.nodes[0].number},
        motion_i_{Kind::kMotion, window.nodes[0].number},
        pose_j_{Kind::kPose, window.nodes[1].number},
        motion_j_{Kind::kMotion, window.nodes[1].number},
        consumed_(FindConsumed()),
        states_(FindStates()),
        columns_(states_) {}

  const std::vector<Track*>& consumed() const { return consumed_; }

  Marginalizer::Result Eliminate() const {
    Marginalizer marginalizer(kDropped, columns_.width() - kDropped);
    AddPrior(marginalizer);
    AddInterval(marginalizer);
    const ceres::CauchyLoss loss(kRobustWidth);
    const ceres::ScaledLoss bearing_loss(&loss, 1 / kCommonErrors, ceres::DO_NOT_TAKE_OWNERSHIP);
    for (const Track* track : consumed_) {
      std::vector<LinearizableBlock> observations;
      for (const TrackObservation& seen : track->observations) {
        observations.push_back(BlockOf(seen.cost.get(), &bearing_loss, StatesOf(*seen.view)));
        observations.back().parameters.push_back(track->landmark.data());
        observations.back().columns.push_back(0);
        observations.back().tangent_sizes.push_back(kLandmarkSize);
      }
      marginalizer.AddLandmark(observations);
    }
    return marginalizer.Finish();
  }

  /// The states of the oldest node, or else those that stay, with their values.
  std::vector<PriorBlock> Blocks(bool of_oldest) const {
    std::vector<PriorBlock> blocks;
    for (const StateName& name : states_) {
      if ((name == pose_i_ || name == motion_i_) != of_oldest) continue;
      PriorBlock& block = blocks.emplace_back(PriorBlock{name, {}});
      std::copy_n(window_.ValuesOf(name), block.Size(), block.at.begin());
    }
    return blocks;
  }

 private:
  /// Tracks whose landmarks the oldest node has seen.
  std::vector<Track*> FindConsumed() const {
    std::vector<Track*> consumed;
    for (auto& [number, track] : window_.tracks)
      if (track.has_landmark &&
          track.observations.front().view->first_node == window_.nodes[0].number)
        consumed.push_back(&track);
    return consumed;
  }

  std::set<StateName> FindStates() const {
    std::set<StateName> states{pose_i_, motion_i_, pose_j_, motion_j_};
    for (const PriorBlock& block : window_.prior.blocks) states.insert(block.name);
    if (interval_.wheels) states.insert(kWheelScale);
    for (const Track* track : consumed_)
      for (const TrackObservation& seen : track->observations)
        for (const StateName& name : StatesOf(*seen.view))
          if (window_.IsEstimated(name)) states.insert(name);
    return states;
  }

  LinearizableBlock BlockOf(const ceres::CostFunction* cost, const ceres::LossFunction* loss,
                            const std::vector<StateName>& names) const {
    LinearizableBlock block{cost, loss, {}, {}, {}};
    for (const StateName& name : names) {
      const bool is_estimated = window_.IsEstimated(name);
      block.parameters.push_back(window_.ValuesOf(name));
      block.columns.push_back(is_estimated ? columns_[name] : 0);
      block.tangent_sizes.push_back(is_estimated ? name.TangentSize() : 0);
    }
    return block;
  }

  void AddPrior(Marginalizer& marginalizer) const {
    const LinearPrior& prior = window_.prior;
    const LinearPriorCost cost(&prior);
    std::vector<StateName> names;
    for (const PriorBlock& block : prior.blocks) names.push_back(block.name);
    const LinearizableBlock block = BlockOf(&cost, nullptr, names);
    marginalizer.Add(block, &prior.score_covariance);
    marginalizer.AddSensitivity(ColumnsOf(block), prior.score_sensitivity);
  }

  void AddInterval(Marginalizer& marginalizer) const {
    const ImuCost imu_cost(&interval_.imu);
    const LinearizableBlock imu =
        BlockOf(&imu_cost, nullptr, {pose_i_, motion_i_, pose_j_, motion_j_});
    marginalizer.Add(imu);
    marginalizer.AddSensitivity(ColumnsOf(imu),
                                ScoreSensitivity(imu_cost, interval_.imu, imu.parameters));
    if (interval_.wheels) {
      const WheelCost cost(*interval_.wheels);
      const ceres::CauchyLoss loss(kRobustWidth);
      marginalizer.Add(BlockOf(&cost, &loss, {pose_i_, motion_i_, pose_j_, kWheelScale}));
    }
    if (interval_.is_still) {
      const StandstillCost cost;
      marginalizer.Add(BlockOf(&cost, nullptr, {pose_i_, pose_j_, motion_j_}));
    }
  }

  SmootherWindow& window_;
  const NodeInterval& interval_;  // from the oldest node to the next
  StateName pose_i_, motion_i_, pose_j_, motion_j_;
  std::vector<Track*> consumed_;
  std::set<StateName> states_;
  ColumnMap columns_;
};

/// Removes the oldest node, its images, and tracks that are over.
void ForgetOldest(SmootherWindow& window) {
  const std::int64_t number = window.nodes.front().number;
  for (auto& [track_number, track] : window.tracks)
    std::erase_if(track.observations,
                  [&](const TrackObservation& seen) { return seen.view->first_node == number; });
  while (!window.views.empty() && window.views.front().first_node == number)
    window.views.pop_front();
  window.nodes.pop_front();
  // Numbers are never reused: a track not seen for a whole window is over.
  const Timestamp begin = window.nodes.front().time;
  std::erase_if(window.tracks, [&](const auto& entry) {
    return entry.second.observations.empty() && entry.second.last_time < begin;
  });
}

}  // namespace

MarginalizedNode MarginalizeOldest(SmootherWindow& window) {
  const OldestSystem system(window);
  Marginalizer::Result result = system.Eliminate();
  LinearPrior prior;
  prior.blocks = system.Blocks(false);
  StateConditional conditional{system.Blocks(true),
                               result.dropped_information.cast<float>(),
                               result.dropped_to_kept.cast<float>(),
                               result.dropped_offset.cast<float>(),
                               result.scores.dropped.cast<float>(),
                               result.scores.cross.cast<float>(),
                               result.scores.dropped_sensitivity.cast<float>(),
                               prior.blocks};
  prior.offset = std::move(result.offset);
  prior.sqrt_information = std::move(result.sqrt_information);
  prior.score_covariance = std::move(result.scores.kept);
  prior.score_sensitivity = std::move(result.scores.kept_sensitivity);
  window.prior = std::move(prior);

  MarginalizedNode marginalized;
  for (Track* track : system.consumed()) {
    if (std::optional<FinishedLandmark> landmark = FinishLandmark(window, *track))
      marginalized.landmarks.push_back(*landmark);
    track->num_consumed += static_cast<int>(track->observations.size());
    track->observations.clear();
    track->has_landmark = false;
  }
  StateNode& oldest = window.nodes.front();
  marginalized.node = {oldest.number,
                       oldest.State(),
                       std::move(oldest.interval),
                       Eigen::Matrix<double, 6, 6>::Zero(),
                       {std::move(conditional), {}}};
  ForgetOldest(window);
  return marginalized;
}

std::optional<Eigen::Matrix<double, 6, 6>> CovarianceOfFirstPose(const LinearPrior& prior) {
  const Eigen::Index width = prior.sqrt_information.cols();
  Eigen::MatrixXd root = prior.sqrt_information;
  root.diagonal().array() += (root.diagonal().array().abs() < kMinRoot).cast<double>() * kMinRoot;
  // The columns of the first pose in (R^T R)^-1.
  const Eigen::MatrixXd selector = Eigen::MatrixXd::Identity(width, kPoseTangentSize);
  Eigen::MatrixXd columns = root.transpose().triangularView<Eigen::Lower>().solve(selector);
  root.triangularView<Eigen::Upper>().solveInPlace(columns);
  const Eigen::MatrixXd sensitivity = columns.transpose() * prior.score_sensitivity;
  const Eigen::Matrix<double, 6, 6> covariance =
      columns.transpose() * prior.score_covariance * columns +
      sensitivity * sensitivity.transpose();
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace parkade

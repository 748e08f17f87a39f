// How FixedLagSmoother condenses its oldest node into the prior.
#include <ceres/loss_function.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <set>
#include <utility>

#include "slam/factors/imu_cost.h"
#include "slam/factors/imu_sensitivity.h"
#include "slam/factors/track_errors.h"
#include "slam/factors/wheel_cost.h"
#include "slam/smoother/fixed_lag_smoother.h"
#include "slam/smoother/marginalizer.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

constexpr StateName kWheelScale{Kind::kWheelScale, 0};

constexpr double kMinRoot = 1e-9;  // of a diagonal of the prior: a direction nothing is known about

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
std::vector<int> ColumnsOf(const LinearisableBlock& block) {
  std::vector<int> columns;
  for (size_t i = 0; i < block.columns.size(); ++i)
    for (int k = 0; k < block.tangent_sizes[i]; ++k) columns.push_back(block.columns[i] + k);
  return columns;
}

}  // namespace

FinishedNode FixedLagSmoother::MarginalizeOldest() {
  StateNode& oldest = nodes_[0];
  StateNode& next = nodes_[1];
  const NodeInterval& interval = *next.interval;

  std::vector<Track*> consumed;
  std::set<StateName> states{{Kind::kPose, oldest.number},
                             {Kind::kMotion, oldest.number},
                             {Kind::kPose, next.number},
                             {Kind::kMotion, next.number}};
  for (const PriorBlock& block : prior_.blocks) states.insert(block.name);
  if (interval.wheels) states.insert(kWheelScale);
  for (auto& [number, track] : tracks_) {
    if (!track.has_landmark || track.observations.front().view->first_node != oldest.number)
      continue;
    consumed.push_back(&track);
    for (const TrackObservation& seen : track.observations)
      for (const StateName& name : StatesOf(*seen.view))
        if (IsEstimated(name)) states.insert(name);
  }
  const ColumnMap columns(states);
  const auto block_of = [&](const ceres::CostFunction* cost, const ceres::LossFunction* loss,
                            const std::vector<StateName>& names) {
    LinearisableBlock block{cost, loss, {}, {}, {}};
    for (const StateName& name : names) {
      block.parameters.push_back(ValuesOf(name));
      block.columns.push_back(IsEstimated(name) ? columns[name] : 0);
      block.tangent_sizes.push_back(IsEstimated(name) ? name.TangentSize() : 0);
    }
    return block;
  };

  constexpr int kDropped = kPoseTangentSize + kMotionSize;
  Marginalizer marginalizer(kDropped, columns.width() - kDropped);
  const LinearPriorCost prior_cost(&prior_);
  std::vector<StateName> prior_states;
  for (const PriorBlock& block : prior_.blocks) prior_states.push_back(block.name);
  const LinearisableBlock prior_block = block_of(&prior_cost, nullptr, prior_states);
  marginalizer.Add(prior_block, &prior_.score_covariance);
  marginalizer.AddSensitivity(ColumnsOf(prior_block), prior_.score_sensitivity);
  const ImuCost imu_cost(&interval.imu);
  const StateName pose_i{Kind::kPose, oldest.number}, motion_i{Kind::kMotion, oldest.number};
  const StateName pose_j{Kind::kPose, next.number}, motion_j{Kind::kMotion, next.number};
  const LinearisableBlock imu_block =
      block_of(&imu_cost, nullptr, {pose_i, motion_i, pose_j, motion_j});
  marginalizer.Add(imu_block);
  marginalizer.AddSensitivity(ColumnsOf(imu_block),
                              ScoreSensitivity(imu_cost, interval.imu, imu_block.parameters));
  if (interval.wheels) {
    const WheelCost cost(*interval.wheels);
    const ceres::CauchyLoss loss(options_.wheel_robust_width);
    marginalizer.Add(block_of(&cost, &loss, {pose_i, motion_i, pose_j, kWheelScale}));
  }
  if (interval.is_still) {
    const StandstillCost cost(options_.standstill);
    marginalizer.Add(block_of(&cost, nullptr, {pose_i, pose_j, motion_j}));
  }
  const ceres::ScaledLoss bearing_loss = BearingLoss(options_.robust_width);
  for (const Track* track : consumed) {
    std::vector<LinearisableBlock> observations;
    for (const TrackObservation& seen : track->observations) {
      observations.push_back(block_of(seen.cost.get(), &bearing_loss, StatesOf(*seen.view)));
      observations.back().parameters.push_back(track->landmark.data());
      observations.back().columns.push_back(0);
      observations.back().tangent_sizes.push_back(kLandmarkSize);
    }
    marginalizer.AddLandmark(observations);
  }
  Marginalizer::Result result = marginalizer.Finish();

  LinearPrior prior;
  for (const StateName& name : states) {
    if (name == pose_i || name == motion_i) continue;
    PriorBlock block{name, {}};
    std::copy_n(ValuesOf(name), block.Size(), block.at.begin());
    prior.blocks.push_back(block);
  }
  StateConditional conditional{{{pose_i, {}}, {motion_i, {}}},
                               result.dropped_information.cast<float>(),
                               result.dropped_to_kept.cast<float>(),
                               result.dropped_offset.cast<float>(),
                               result.scores.dropped.cast<float>(),
                               result.scores.cross.cast<float>(),
                               result.scores.dropped_sensitivity.cast<float>(),
                               prior.blocks};
  std::copy(oldest.pose.begin(), oldest.pose.end(), conditional.states[0].at.begin());
  std::copy(oldest.motion.begin(), oldest.motion.end(), conditional.states[1].at.begin());
  prior.offset = std::move(result.offset);
  prior.sqrt_information = std::move(result.sqrt_information);
  prior.score_covariance = std::move(result.scores.kept);
  prior.score_sensitivity = std::move(result.scores.kept_sensitivity);
  prior_ = std::move(prior);

  for (Track* track : consumed) {
    FinishLandmark(*track);
    track->num_consumed += static_cast<int>(track->observations.size());
    track->observations.clear();
    track->has_landmark = false;
  }
  FinishedNode finished{oldest.number,
                        oldest.State(),
                        std::move(oldest.interval),
                        oldest_covariance_,
                        {std::move(conditional), std::exchange(reopened_, {})}};
  ForgetOldest();
  UpdateOldestCovariance();
  return finished;
}

void FixedLagSmoother::ForgetOldest() {
  const std::int64_t number = nodes_.front().number;
  for (auto& [track_number, track] : tracks_)
    std::erase_if(track.observations,
                  [&](const TrackObservation& seen) { return seen.view->first_node == number; });
  while (!views_.empty() && views_.front().first_node == number) views_.pop_front();
  nodes_.pop_front();
  // Numbers are never reused: a track not seen for a whole window is over.
  const Timestamp begin = nodes_.front().time;
  std::erase_if(tracks_, [&](const auto& entry) {
    return entry.second.observations.empty() && entry.second.last_time < begin;
  });
}

void FixedLagSmoother::UpdateOldestCovariance() {
  const Eigen::Index width = prior_.sqrt_information.cols();
  Eigen::MatrixXd root = prior_.sqrt_information;
  root.diagonal().array() += (root.diagonal().array().abs() < kMinRoot).cast<double>() * kMinRoot;
  // Columns of the oldest pose, the first, of (R^T R)^-1.
  const Eigen::MatrixXd selector = Eigen::MatrixXd::Identity(width, kPoseTangentSize);
  Eigen::MatrixXd columns = root.transpose().triangularView<Eigen::Lower>().solve(selector);
  root.triangularView<Eigen::Upper>().solveInPlace(columns);
  const Eigen::MatrixXd sensitivity = columns.transpose() * prior_.score_sensitivity;
  const Eigen::Matrix<double, 6, 6> covariance =
      columns.transpose() * prior_.score_covariance * columns +
      sensitivity * sensitivity.transpose();
  if (covariance.allFinite()) oldest_covariance_ = covariance;
}

}  // namespace parkade

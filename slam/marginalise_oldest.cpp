// How FixedLagSmoother condenses its oldest knot into the prior.
#include <ceres/loss_function.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <set>

#include "slam/fixed_lag_smoother.h"
#include "slam/imu_cost.h"
#include "slam/marginaliser.h"
#include "slam/wheel_cost.h"

namespace parkade {
namespace {

using Kind = PriorBlock::Kind;

constexpr std::int64_t kScaleKnot = std::numeric_limits<std::int64_t>::max();  // sorts last

constexpr double kMinRoot = 1e-9;  // of a diagonal of the prior: a direction nothing is known about

/// Names a state; ordered as the columns of the system are: by knot, pose first.
using StateName = std::pair<std::int64_t, Kind>;

StateName NameOf(const PriorBlock& block) {
  return {block.kind == Kind::kWheelScale ? kScaleKnot : block.knot, block.kind};
}

int TangentSizeOf(const StateName& name) { return PriorBlock{name.second, name.first, {}}.TangentSize(); }

/// Where each state's tangent begins among the columns.
class ColumnMap {
 public:
  explicit ColumnMap(const std::set<StateName>& states) {
    for (const StateName& name : states) {
      columns_[name] = width_;
      width_ += TangentSizeOf(name);
    }
  }
  int operator[](const StateName& name) const { return columns_.at(name); }
  int width() const { return width_; }

 private:
  std::map<StateName, int> columns_;
  int width_ = 0;
};

}  // namespace

FinishedKnot FixedLagSmoother::MarginaliseOldest() {
  Knot& oldest = knots_[0];
  Knot& next = knots_[1];
  const KnotInterval& interval = *next.interval;

  std::vector<Track*> consumed;
  std::set<StateName> states{{oldest.number, Kind::kPose},
                             {oldest.number, Kind::kMotion},
                             {next.number, Kind::kPose},
                             {next.number, Kind::kMotion}};
  for (const PriorBlock& block : prior_.blocks) states.insert(NameOf(block));
  if (interval.wheels) states.insert({kScaleKnot, Kind::kWheelScale});
  for (auto& [number, track] : tracks_) {
    if (!track.has_landmark || track.observations.front().view->first_knot != oldest.number) continue;
    consumed.push_back(&track);
    for (const TrackObservation& seen : track.observations) {
      states.insert({seen.view->first_knot, Kind::kPose});
      if (seen.view->second_knot) states.insert({*seen.view->second_knot, Kind::kPose});
    }
  }
  const ColumnMap columns(states);
  const auto values_of = [&](const StateName& name) -> const double* {
    if (name.second == Kind::kWheelScale) return &wheel_scale_;
    Knot& knot = KnotNumbered(name.first);
    return name.second == Kind::kPose ? knot.pose.data() : knot.motion.data();
  };
  const auto block_of = [&](const ceres::CostFunction* cost, const ceres::LossFunction* loss,
                            const std::vector<StateName>& names) {
    LinearisableBlock block{cost, loss, {}, {}, {}};
    for (const StateName& name : names) {
      block.parameters.push_back(values_of(name));
      block.columns.push_back(columns[name]);
      block.tangent_sizes.push_back(TangentSizeOf(name));
    }
    return block;
  };

  constexpr int kDropped = kPoseTangentSize + kMotionSize;
  Marginaliser marginaliser(kDropped, columns.width() - kDropped);
  const LinearPriorCost prior_cost(&prior_);
  std::vector<StateName> prior_states;
  for (const PriorBlock& block : prior_.blocks) prior_states.push_back(NameOf(block));
  marginaliser.Add(block_of(&prior_cost, nullptr, prior_states));
  const ImuCost imu_cost(&interval.imu, &oldest.first_estimate, &next.first_estimate);
  const StateName pose_i{oldest.number, Kind::kPose}, motion_i{oldest.number, Kind::kMotion};
  const StateName pose_j{next.number, Kind::kPose}, motion_j{next.number, Kind::kMotion};
  marginaliser.Add(block_of(&imu_cost, nullptr, {pose_i, motion_i, pose_j, motion_j}));
  if (interval.wheels) {
    const WheelCost cost(*interval.wheels, &oldest.first_estimate, &next.first_estimate);
    const ceres::CauchyLoss loss(options_.wheel_robust_width);
    marginaliser.Add(block_of(&cost, &loss, {pose_i, motion_i, pose_j, {kScaleKnot, Kind::kWheelScale}}));
  }
  if (interval.is_still) {
    const StandstillCost cost(options_.standstill, &oldest.first_estimate, &next.first_estimate);
    marginaliser.Add(block_of(&cost, nullptr, {pose_i, pose_j, motion_j}));
  }
  const ceres::CauchyLoss bearing_loss(options_.robust_width);
  for (const Track* track : consumed) {
    std::vector<LinearisableBlock> observations;
    for (const TrackObservation& seen : track->observations) {
      std::vector<StateName> names{{seen.view->first_knot, Kind::kPose}};
      if (seen.view->second_knot) names.push_back({*seen.view->second_knot, Kind::kPose});
      observations.push_back(block_of(seen.cost.get(), &bearing_loss, names));
      observations.back().parameters.push_back(track->landmark.data());
      observations.back().columns.push_back(0);
      observations.back().tangent_sizes.push_back(kLandmarkSize);
    }
    marginaliser.AddLandmark(observations);
  }
  Marginaliser::Result result = marginaliser.Finish();

  // Residuals were evaluated at the current values, Jacobians at first estimates:
  // refer the prior to the latter.
  LinearPrior prior;
  Eigen::VectorXd since_first = Eigen::VectorXd::Zero(result.sqrt_information.cols());
  for (const StateName& name : states) {
    if (name.first == oldest.number) continue;
    PriorBlock block{name.second, name.second == Kind::kWheelScale ? -1 : name.first, {}};
    const double* at = values_of(name);
    if (options_.first_estimates && name.second != Kind::kWheelScale) {
      Knot& knot = KnotNumbered(name.first);
      if (!knot.first_estimate.is_fixed) knot.first_estimate = {true, knot.pose, knot.motion};
      at = name.second == Kind::kPose ? knot.first_estimate.pose.data() : knot.first_estimate.motion.data();
    }
    std::copy_n(at, block.Size(), block.at.begin());
    double* change = since_first.data() + columns[name] - kDropped;
    if (name.second == Kind::kPose)
      PoseManifold().Minus(values_of(name), at, change);
    else
      for (int k = 0; k < block.Size(); ++k) change[k] = values_of(name)[k] - at[k];
    prior.blocks.push_back(block);
  }
  KnotConditional conditional{result.dropped_information.cast<float>(), result.dropped_to_kept.cast<float>(),
                              (result.dropped_offset - result.dropped_to_kept * since_first).cast<float>(),
                              prior.blocks};
  prior.offset = result.offset - result.sqrt_information * since_first;
  prior.sqrt_information = std::move(result.sqrt_information);
  prior_ = std::move(prior);

  for (Track* track : consumed) {
    FinishLandmark(*track);
    track->num_consumed += static_cast<int>(track->observations.size());
    track->observations.clear();
    track->has_landmark = false;
  }
  FinishedKnot finished{oldest.number, oldest.State(), std::move(oldest.interval), oldest_covariance_,
                        std::move(conditional)};
  ForgetOldest();
  UpdateOldestCovariance();
  return finished;
}

void FixedLagSmoother::ForgetOldest() {
  const std::int64_t number = knots_.front().number;
  for (auto& [track_number, track] : tracks_)
    std::erase_if(track.observations, [&](const TrackObservation& seen) { return seen.view->first_knot == number; });
  while (!views_.empty() && views_.front().first_knot == number) views_.pop_front();
  knots_.pop_front();
  // Numbers are never reused: a track not seen for a whole window is over.
  const Timestamp begin = knots_.front().time;
  std::erase_if(tracks_,
                [&](const auto& entry) { return entry.second.observations.empty() && entry.second.last_time < begin; });
}

void FixedLagSmoother::FinishLandmark(const Track& track) {
  const double inverse_distance = track.landmark[2];
  if (inverse_distance <= 0) return;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const TrackObservation& seen : track.observations) {
    const double* parameters[3] = {seen.view->geometry.first_pose, seen.view->geometry.second_pose,
                                   track.landmark.data()};
    if (!seen.view->geometry.second_pose) parameters[1] = track.landmark.data();
    Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor> jacobian;
    double residual[2];
    double* jacobians[3] = {nullptr, nullptr, nullptr};
    jacobians[seen.view->geometry.second_pose ? 2 : 1] = jacobian.data();
    if (!seen.cost->Evaluate(parameters, residual, jacobians)) return;
    information += jacobian.transpose() * jacobian;
  }
  const double determinant = information.determinant();
  if (!(determinant > 0)) return;
  const double inverse_distance_sigma = std::sqrt(information.inverse()(2, 2));
  const double sigma = inverse_distance_sigma / (inverse_distance * inverse_distance);
  if (!std::isfinite(sigma)) return;
  finished_landmarks_.push_back({knots_.front().number, track.first_time, track.camera,
                                 track.ray.Point(track.landmark.data()), sigma,
                                 track.num_consumed + static_cast<int>(track.observations.size())});
}

Eigen::MatrixXd FixedLagSmoother::LastCovariance() const {
  Eigen::MatrixXd root = prior_.sqrt_information;
  root.diagonal().array() += (root.diagonal().array().abs() < kMinRoot).cast<double>() * kMinRoot;
  const Eigen::MatrixXd inverse =
      root.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(root.rows(), root.cols()));
  return inverse * inverse.transpose();
}

void FixedLagSmoother::UpdateOldestCovariance() {
  const Eigen::Index width = prior_.sqrt_information.cols();
  Eigen::MatrixXd root = prior_.sqrt_information;
  root.diagonal().array() += (root.diagonal().array().abs() < kMinRoot).cast<double>() * kMinRoot;
  // cov = (R^T R)^-1 = Z^T Z with R^T Z = selector of the oldest pose, the first columns.
  const Eigen::MatrixXd selector = Eigen::MatrixXd::Identity(width, kPoseTangentSize);
  const Eigen::MatrixXd z = root.transpose().triangularView<Eigen::Lower>().solve(selector);
  const Eigen::Matrix<double, 6, 6> covariance = z.transpose() * z;
  if (covariance.allFinite()) oldest_covariance_ = covariance;
}

}  // namespace parkade

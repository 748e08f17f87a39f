#include "slam/smoother/fixed_lag_smoother.h"

#include <algorithm>
#include <cassert>

#include "slam/factors/imu_sensitivity.h"
#include "slam/factors/measurement_model.h"
#include "slam/smoother/marginalize_oldest.h"
#include "slam/smoother/window_cameras.h"
#include "slam/smoother/window_graph.h"
#include "slam/smoother/window_landmarks.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

// First-order bias correction of a preintegration is trusted this far.
constexpr double kMaxGyroscopeBiasChange = 2e-3;      // [rad/s]
constexpr double kMaxAccelerometerBiasChange = 0.05;  // [m/s^2]
constexpr double kAtNode =
    1e-9;  // an image this near to a node (fraction of the interval) is at it
constexpr int kMaxRejections = 2;
constexpr int kStartIterations = 15;  // until the window is full for the first time

StateNode NodeOf(const MotionState& state, std::int64_t number) {
  StateNode node;
  node.number = number;
  node.time = state.time;
  StateToParameters(state, node.pose.data(), node.motion.data());
  return node;
}

/// What is known of the first node and of the wheels before the drive tells.
LinearPrior PriorOfStart(const StateNode& node, const StartUncertainty& uncertainty) {
  constexpr double kExact = 1e-4;  // [rad], [m]: fixes yaw and position, stays well conditioned
  const Eigen::Vector3d up =
      PoseFromParameters(node.pose.data()).rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d about_up = up * up.transpose();
  LinearPrior prior;
  prior.blocks = {{{Kind::kPose, 0}, {}}, {{Kind::kMotion, 0}, {}}, {{Kind::kWheelScale, 0}, {}}};
  std::copy(node.pose.begin(), node.pose.end(), prior.blocks[0].at.begin());
  std::copy(node.motion.begin(), node.motion.end(), prior.blocks[1].at.begin());
  Eigen::MatrixXd& root = prior.sqrt_information;
  root = Eigen::MatrixXd::Zero(16, 16);
  root.topLeftCorner<3, 3>() =
      (Eigen::Matrix3d::Identity() - about_up) / uncertainty.tilt + about_up / kExact;
  root.diagonal().segment<3>(3).setConstant(1 / kExact);
  root.diagonal().segment<3>(6).setConstant(1 / uncertainty.velocity);
  root.diagonal().segment<3>(9).setConstant(1 / uncertainty.gyroscope_bias);
  root.diagonal().segment<3>(12).setConstant(1 / uncertainty.accelerometer_bias);
  root(15, 15) = 1 / kWheelScaleSigma;
  prior.offset = Eigen::VectorXd::Zero(16);
  return prior;
}

}  // namespace

FixedLagSmoother::FixedLagSmoother(const Rig& rig, const SmootherOptions& options)
    : options_(options) {
  options_.Validate();
  AddCameras(rig, options_.calibration, window_);
}

void FixedLagSmoother::Start(const MotionState& first, const StartUncertainty& uncertainty,
                             std::vector<NewImage> images) {
  assert(window_.nodes.empty());
  window_.nodes.push_back(NodeOf(first, 0));
  LinearPrior& prior = window_.prior;
  prior = PriorOfStart(window_.nodes.front(), uncertainty);
  AddPriorOfCameras(window_);
  prior.score_covariance = prior.sqrt_information.transpose() * prior.sqrt_information;
  prior.score_sensitivity = Eigen::MatrixXd::Zero(prior.sqrt_information.cols(), kImuSensitivities);
  const Eigen::Vector3d up = first.odom_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  oldest_covariance_.topLeftCorner<3, 3>() =
      (Eigen::Matrix3d::Identity() - up * up.transpose()) * std::pow(uncertainty.tilt, 2);
  AddImages(std::move(images), 0, 0);
}

void FixedLagSmoother::AddNode(NodeInterval interval, std::vector<NewImage> images) {
  assert(!window_.nodes.empty());
  const StateNode& last = window_.nodes.back();
  MotionState state = Propagate(last.State(), interval.imu.increment());
  if (interval.is_still) {  // an integrated bias must not make the prediction walk
    state.odom_from_imu = last.State().odom_from_imu;
    state.velocity_in_odom.setZero();
  }
  state.time = interval.imu.end();
  StateNode node = NodeOf(state, last.number + 1);
  node.interval = std::move(interval);
  window_.nodes.push_back(std::move(node));
  AddImages(std::move(images), window_.nodes.back().number - 1, window_.nodes.back().number);
}

void FixedLagSmoother::AddImages(std::vector<NewImage> images, std::int64_t node_before,
                                 std::int64_t node_at) {
  const size_t first_new_view = window_.views.size();
  for (const NewImage& image : images) AddView(image, node_before, node_at);
  window_.PointViewsAtNodes();
  if (options_.calibration.notice_jumps) LookForJumps(first_new_view);
  for (auto& [number, track] : window_.tracks)
    if (track.has_landmark)
      for (TrackObservation& seen : track.observations)
        if (!seen.cost)
          seen.cost = std::make_unique<BearingCost>(&seen.view->geometry, &track.ray, seen.bearing);
}

void FixedLagSmoother::AddView(const NewImage& image, std::int64_t node_before,
                               std::int64_t node_at) {
  const bool is_at_node = node_before == node_at || image.interpolation.fraction > 1 - kAtNode;
  WindowView& view = window_.views.emplace_back();
  view.time = image.frame.time;
  view.camera = image.frame.camera;
  view.first_node = is_at_node ? node_at : node_before;
  if (!is_at_node) view.second_node = node_at;
  view.angular_velocity = image.angular_velocity;
  view.geometry.time_offset = image.frame.time_offset;
  const CameraSettings& settings = window_.camera_settings[static_cast<size_t>(view.camera)];
  view.geometry.holds_time_offset = !settings.has_time_offset;
  view.geometry.holds_line_delay = !settings.has_line_delay;
  if (!is_at_node) view.geometry.interpolation = image.interpolation;
  AddObservations(image, view);
}

void FixedLagSmoother::AddObservations(const NewImage& image, WindowView& view) {
  const double middle_row = window_.camera_settings[static_cast<size_t>(view.camera)].middle_row;
  RecordedImage& recorded = recorded_images_.emplace_back(RecordedImage{view.time,
                                                                        view.camera,
                                                                        image.frame.time_offset,
                                                                        view.first_node,
                                                                        view.second_node,
                                                                        view.geometry.interpolation,
                                                                        view.angular_velocity,
                                                                        {}});
  for (const FeatureObservation& seen : image.frame.observations) {
    recorded.observations.push_back({seen.track, seen.bearing.cast<float>(),
                                     static_cast<float>(seen.sigma),
                                     static_cast<float>(seen.pixel.y() - middle_row)});
    Track& track = window_.tracks[seen.track];
    track.last_time = view.time;
    if (track.num_rejections > kMaxRejections) continue;
    if (track.observations.empty() && track.num_consumed == 0) {
      track.number = seen.track;
      track.camera = view.camera;
      track.first_time = view.time;
    }
    track.observations.push_back({&view, window_.BearingOf(seen, view.camera), nullptr});
  }
}

void FixedLagSmoother::LookForJumps(size_t first_new_view) {
  for (MountJump& found : FindMountJumps(first_new_view, window_)) {
    if (found.reopened) reopened_.push_back(std::move(*found.reopened));
    jumps_.push_back(found.jump);
  }
}

SolveSummary FixedLagSmoother::Solve() {
  for (size_t j = 1; j < window_.nodes.size(); ++j) {
    const ImuBias bias = BiasFromParameters(window_.nodes[j - 1].motion.data());
    ImuPreintegration& imu = window_.nodes[j].interval->imu;
    if ((bias.gyroscope - imu.bias().gyroscope).norm() > kMaxGyroscopeBiasChange ||
        (bias.accelerometer - imu.bias().accelerometer).norm() > kMaxAccelerometerBiasChange)
      imu.Reintegrate(bias);
  }
  StartLandmarks(options_.landmarks, window_);
  const bool is_full = static_cast<int>(window_.nodes.size()) >= options_.window_nodes;
  const SolveSummary summary =
      WindowGraph(window_).Solve(has_been_full_ ? options_.max_iterations : kStartIterations);
  has_been_full_ = has_been_full_ || is_full;
  RejectOutliers(window_);
  UpdateCameraNoise(window_);
  return summary;
}

std::vector<FinishedNode> FixedLagSmoother::DropOldest() {
  std::vector<FinishedNode> finished;
  while (static_cast<int>(window_.nodes.size()) > options_.window_nodes)
    finished.push_back(RemoveOldest());
  return finished;
}

std::vector<FinishedNode> FixedLagSmoother::Finish() {
  std::vector<FinishedNode> finished;
  while (window_.nodes.size() > 1) finished.push_back(RemoveOldest());
  if (!window_.nodes.empty()) {
    finished.push_back({window_.nodes.front().number,
                        window_.nodes.front().State(),
                        window_.nodes.front().interval,
                        oldest_covariance_,
                        {}});
  }
  return finished;
}

FinishedNode FixedLagSmoother::RemoveOldest() {
  MarginalizedNode oldest = MarginalizeOldest(window_);
  oldest.node.covariance = oldest_covariance_;
  oldest.node.conditionals.reopened = std::exchange(reopened_, {});
  std::move(oldest.landmarks.begin(), oldest.landmarks.end(),
            std::back_inserter(finished_landmarks_));
  oldest_covariance_ = CovarianceOfFirstPose(window_.prior).value_or(oldest_covariance_);
  return std::move(oldest.node);
}

JointEstimate FixedLagSmoother::LastEstimate() const {
  const Eigen::MatrixXd model = window_.prior.ModelCovariance();
  JointEstimate last{window_.prior.blocks, window_.prior.Covariance(), model,
                     -model * window_.prior.score_sensitivity};
  for (PriorBlock& block : last.states)
    if (const double* values = window_.ValuesOf(block.name))
      std::copy_n(values, block.Size(), block.at.begin());
  return last;
}

std::vector<FinishedLandmark> FixedLagSmoother::TakeLandmarks() {
  return std::exchange(finished_landmarks_, {});
}

}  // namespace parkade

#include "slam/smoother/fixed_lag_smoother.h"

#include <algorithm>
#include <cassert>

#include "core/error.h"
#include "slam/factors/imu_sensitivity.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

// First-order bias correction of a preintegration is trusted this far.
constexpr double kMaxGyroscopeBiasChange = 2e-3;      // [rad/s]
constexpr double kMaxAccelerometerBiasChange = 0.05;  // [m/s^2]
constexpr double kAtNode =
    1e-9;  // an image this near to a node (fraction of the interval) is at it
constexpr int kMaxRejections = 2;

}  // namespace

void SmootherOptions::Validate() const {
  Require(window_nodes >= 4 && window_nodes <= 100, ErrorCode::kUsage,
          "'window_nodes' must be in 4..100");
  Require(landmarks >= 10 && landmarks <= 2000, ErrorCode::kUsage,
          "'landmarks' must be in 10..2000");
  Require(max_iterations >= 1 && start_iterations >= 1, ErrorCode::kUsage,
          "iterations must be positive");
  Require(robust_width > 0 && wheel_robust_width > 0 && max_bearing_error > 0 && min_distance > 0 &&
              wheel_scale_sigma > 0,
          ErrorCode::kUsage, "widths, limits and sigmas of the smoother must be positive");
  standstill.Validate();
  calibration.Validate();
}

void CalibrationOptions::Validate() const {
  Require(rotation_deg > 0 && translation_share > 0 && translation >= 1e-3 &&
              time_offset_sigma > 0 && line_delay_share > 0,
          ErrorCode::kUsage,
          "sigmas of the calibration must be positive, and that of translation at least 1 mm");
}

FixedLagSmoother::FixedLagSmoother(const Rig& rig, const SmootherOptions& options)
    : options_(options), camera_noise_scales_(rig.cameras.size(), 1.0) {
  options_.Validate();
  AddCameras(rig);
}

void FixedLagSmoother::Start(const MotionState& first, const StartUncertainty& uncertainty,
                             std::vector<NewImage> images) {
  assert(nodes_.empty());
  StateNode& node = nodes_.emplace_back();
  node.time = first.time;
  PoseToParameters(first.odom_from_imu, node.pose.data());
  Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(node.motion.data()) << first.velocity_in_odom,
      first.gyroscope_bias, first.accelerometer_bias;

  constexpr double kExact = 1e-4;  // [rad], [m]: fixes yaw and position, stays well conditioned
  const Eigen::Vector3d up = first.odom_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d about_up = up * up.transpose();
  prior_.blocks = {{{Kind::kPose, 0}, {}}, {{Kind::kMotion, 0}, {}}, {{Kind::kWheelScale, 0}, {}}};
  std::copy(node.pose.begin(), node.pose.end(), prior_.blocks[0].at.begin());
  std::copy(node.motion.begin(), node.motion.end(), prior_.blocks[1].at.begin());
  prior_.blocks[2].at[0] = wheel_scale_;
  prior_.sqrt_information = Eigen::MatrixXd::Zero(16, 16);
  prior_.sqrt_information.topLeftCorner<3, 3>() =
      (Eigen::Matrix3d::Identity() - about_up) / uncertainty.tilt + about_up / kExact;
  prior_.sqrt_information.diagonal().segment<3>(3).setConstant(1 / kExact);
  prior_.sqrt_information.diagonal().segment<3>(6).setConstant(1 / uncertainty.velocity);
  prior_.sqrt_information.diagonal().segment<3>(9).setConstant(1 / uncertainty.gyroscope_bias);
  prior_.sqrt_information.diagonal().segment<3>(12).setConstant(1 / uncertainty.accelerometer_bias);
  prior_.sqrt_information(15, 15) =
      1 / (options_.estimate_wheel_scale ? options_.wheel_scale_sigma : kExact);
  prior_.offset = Eigen::VectorXd::Zero(16);
  AddPriorOfCameras();
  prior_.score_covariance = prior_.sqrt_information.transpose() * prior_.sqrt_information;
  prior_.score_sensitivity =
      Eigen::MatrixXd::Zero(prior_.sqrt_information.cols(), kImuSensitivities);
  oldest_covariance_.topLeftCorner<3, 3>() =
      (Eigen::Matrix3d::Identity() - about_up) * std::pow(uncertainty.tilt, 2);
  AddImages(std::move(images), 0, 0);
}

void FixedLagSmoother::AddNode(NodeInterval interval, std::vector<NewImage> images) {
  assert(!nodes_.empty());
  const StateNode& last = nodes_.back();
  MotionState state = Propagate(last.State(), interval.imu.increment());
  if (interval.is_still) {  // an integrated bias must not make the prediction walk
    state.odom_from_imu = last.State().odom_from_imu;
    state.velocity_in_odom.setZero();
  }
  StateNode node;
  node.number = last.number + 1;
  node.time = interval.imu.end();
  PoseToParameters(state.odom_from_imu, node.pose.data());
  Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(node.motion.data()) << state.velocity_in_odom,
      state.gyroscope_bias, state.accelerometer_bias;
  node.interval = std::move(interval);
  nodes_.push_back(std::move(node));
  AddImages(std::move(images), nodes_.back().number - 1, nodes_.back().number);
}

void FixedLagSmoother::AddImages(std::vector<NewImage> images, std::int64_t node_before,
                                 std::int64_t node_at) {
  const size_t first_new_view = views_.size();
  for (NewImage& image : images) {
    const bool is_at_node = node_before == node_at || image.interpolation.fraction > 1 - kAtNode;
    WindowView& view = views_.emplace_back();
    view.time = image.frame.time;
    view.camera = image.frame.camera;
    view.first_node = is_at_node ? node_at : node_before;
    if (!is_at_node) view.second_node = node_at;
    view.angular_velocity = image.angular_velocity;
    view.geometry.time_offset = image.frame.time_offset;
    const CameraSettings& settings = camera_settings_[static_cast<size_t>(view.camera)];
    view.geometry.holds_time_offset = !settings.has_time_offset;
    view.geometry.holds_line_delay = !settings.has_line_delay;
    if (!is_at_node) view.geometry.interpolation = image.interpolation;
    RecordedImage& recorded =
        recorded_images_.emplace_back(RecordedImage{view.time,
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
                                       static_cast<float>(seen.pixel.y() - settings.middle_row)});
      Track& track = tracks_[seen.track];
      track.last_time = view.time;
      if (track.num_rejections > kMaxRejections) continue;
      if (track.observations.empty() && track.num_consumed == 0) {
        track.number = seen.track;
        track.camera = view.camera;
        track.first_time = view.time;
      }
      track.observations.push_back({&view, BearingOf(seen, view.camera), nullptr});
    }
  }
  PointViewsAtNodes();
  if (options_.calibration.notice_jumps) LookForJumps(first_new_view);
  for (auto& [number, track] : tracks_)
    if (track.has_landmark)
      for (TrackObservation& seen : track.observations)
        if (!seen.cost)
          seen.cost = std::make_unique<BearingCost>(&seen.view->geometry, &track.ray, seen.bearing);
}

void FixedLagSmoother::PointViewsAtNodes() {
  for (WindowView& view : views_) {
    const StateNode& first = NodeNumbered(view.first_node);
    const CameraParameters& camera = cameras_[static_cast<size_t>(view.camera)];
    ImageView& geometry = view.geometry;
    geometry.extrinsics = camera.extrinsics.data();
    geometry.timing = camera.timing.data();
    geometry.first_pose = first.pose.data();
    geometry.velocity_in_odom = Eigen::Vector3d::Map(first.motion.data());
    geometry.angular_velocity =
        view.angular_velocity - BiasFromParameters(first.motion.data()).gyroscope;
    if (view.second_node) {
      const StateNode& second = NodeNumbered(*view.second_node);
      geometry.second_pose = second.pose.data();
      geometry.velocity_in_odom +=
          geometry.interpolation.fraction *
          (Eigen::Vector3d::Map(second.motion.data()) - geometry.velocity_in_odom);
    }
    geometry.Update();
  }
}

SolveSummary FixedLagSmoother::Solve() {
  for (size_t j = 1; j < nodes_.size(); ++j) {
    const ImuBias bias = BiasFromParameters(nodes_[j - 1].motion.data());
    ImuPreintegration& imu = nodes_[j].interval->imu;
    if ((bias.gyroscope - imu.bias().gyroscope).norm() > kMaxGyroscopeBiasChange ||
        (bias.accelerometer - imu.bias().accelerometer).norm() > kMaxAccelerometerBiasChange)
      imu.Reintegrate(bias);
  }
  StartLandmarks();
  const bool is_full = static_cast<int>(nodes_.size()) >= options_.window_nodes;
  const SolveSummary summary =
      SolveWindow(has_been_full_ ? options_.max_iterations : options_.start_iterations);
  has_been_full_ = has_been_full_ || is_full;
  RejectOutliers();
  if (options_.scale_camera_noise) UpdateCameraNoise();
  return summary;
}

std::vector<FinishedNode> FixedLagSmoother::DropOldest() {
  std::vector<FinishedNode> finished;
  while (static_cast<int>(nodes_.size()) > options_.window_nodes)
    finished.push_back(MarginalizeOldest());
  return finished;
}

std::vector<FinishedNode> FixedLagSmoother::Finish() {
  std::vector<FinishedNode> finished;
  while (nodes_.size() > 1) finished.push_back(MarginalizeOldest());
  if (!nodes_.empty()) {
    finished.push_back({nodes_.front().number,
                        nodes_.front().State(),
                        nodes_.front().interval,
                        oldest_covariance_,
                        {}});
  }
  return finished;
}

JointEstimate FixedLagSmoother::LastEstimate() const {
  const Eigen::MatrixXd by_model = prior_.ModelCovariance();
  JointEstimate last{prior_.blocks, prior_.Covariance(), by_model,
                     -by_model * prior_.score_sensitivity};
  for (PriorBlock& block : last.states)
    if (const double* values = ValuesOf(block.name))
      std::copy_n(values, block.Size(), block.at.begin());
  return last;
}

std::vector<StateName> FixedLagSmoother::StatesOf(const WindowView& view) {
  std::vector<StateName> states{{Kind::kPose, view.first_node}};
  if (view.second_node) states.push_back({Kind::kPose, *view.second_node});
  states.push_back({Kind::kExtrinsics, view.camera});
  states.push_back({Kind::kTiming, view.camera});
  return states;
}

bool FixedLagSmoother::IsEstimated(const StateName& name) const {
  if (name.IsOfNode() || name.kind == Kind::kWheelScale) return true;
  const CameraSettings& settings = camera_settings_[static_cast<size_t>(name.number)];
  return name.kind == Kind::kExtrinsics ? settings.has_extrinsics
                                        : settings.has_time_offset || settings.has_line_delay;
}

const double* FixedLagSmoother::ValuesOf(const StateName& name) const {
  const auto camera = static_cast<size_t>(name.number);
  switch (name.kind) {
    case Kind::kPose: return NodeNumbered(name.number).pose.data();
    case Kind::kMotion: return NodeNumbered(name.number).motion.data();
    case Kind::kWheelScale: return &wheel_scale_;
    case Kind::kExtrinsics: return cameras_[camera].extrinsics.data();
    case Kind::kTiming: return cameras_[camera].timing.data();
  }
  return nullptr;
}

std::vector<FinishedLandmark> FixedLagSmoother::TakeLandmarks() {
  return std::exchange(finished_landmarks_, {});
}

int FixedLagSmoother::NumLandmarks() const {
  return static_cast<int>(std::count_if(
      tracks_.begin(), tracks_.end(), [](const auto& entry) { return entry.second.has_landmark; }));
}

}  // namespace parkade

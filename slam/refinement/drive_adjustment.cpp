#include "slam/refinement/drive_adjustment.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/error.h"
#include "core/statistics.h"
#include "slam/factors/imu_cost.h"
#include "slam/factors/relative_pose_cost.h"
#include "slam/factors/wheel_cost.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

constexpr double kHeld = 1e-6;                   // sigma of what must not move
constexpr double kFirstGyroscopeBias = 0.02;     // [rad/s] before the drive tells
constexpr double kFirstAccelerometerBias = 0.3;  // [m/s^2] also
// Cameras this near to each other are one stereo head, whose angles odometry knows better than a
// batch without its ties.
constexpr double kHeadSize = 1.0;      // [m]
constexpr double kFirstVelocity = 30;  // [m/s] also

/// Sum of squares of a cost at its parameters, per residual.
double MeanSquare(const ceres::CostFunction& cost, const std::vector<double*>& blocks) {
  Eigen::VectorXd residual(cost.num_residuals());
  if (!cost.Evaluate(blocks.data(), residual.data(), nullptr)) return 0;
  return residual.squaredNorm() / static_cast<double>(residual.size());
}

LinearPrior PriorOf(const StateName& name, const double* at,
                    const Eigen::MatrixXd& sqrt_information) {
  LinearPrior prior;
  prior.blocks.push_back({name, {}});
  std::copy_n(at, name.Size(), prior.blocks.back().at.begin());
  prior.sqrt_information = sqrt_information;
  prior.offset = Eigen::VectorXd::Zero(sqrt_information.rows());
  return prior;
}

}  // namespace

DriveAdjustment::DriveAdjustment(const DriveMeasurements& measurements, const Rig& rig,
                                 const std::vector<MotionState>& start,
                                 const RefinementOptions& options)
    : options_(options), camera_priors_(measurements.shared.camera_priors) {
  assert(start.size() == measurements.nodes.size() && !start.empty());
  const std::vector<ChosenTrack> tracks = ChooseTracks(measurements, options);
  values_.reserve(start.size() * (kPoseSize + kMotionSize) +
                  measurements.shared.cameras.size() * (kPoseSize + kTimingSize) + 1 + kSiteSize +
                  tracks.size() * kLandmarkSize);
  AddNodes(measurements, start);
  HoldHeads(rig);
  AddPriors(rig);
  AddImages(measurements);
  AddLandmarks(measurements, tracks);
}

DriveAdjustment::~DriveAdjustment() = default;

void DriveAdjustment::AddNodes(const DriveMeasurements& measurements,
                               const std::vector<MotionState>& start) {
  const auto add = [this](const auto& block) {
    values_.insert(values_.end(), block.begin(), block.end());
    return values_.data() + values_.size() - block.size();
  };
  for (size_t i = 0; i < start.size(); ++i) {
    const MotionState& state = start[i];
    std::array<double, kPoseSize> pose{};
    PoseToParameters(state.odom_from_imu, pose.data());
    std::array<double, kMotionSize> motion{};
    Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(motion.data()) << state.velocity_in_odom,
        state.gyroscope_bias, state.accelerometer_bias;
    AdjustedNode& node = nodes_.emplace_back();
    node.time = state.time;
    node.pose = add(pose);
    node.motion = add(motion);
    node.interval = measurements.IntervalBefore(i);
    if (node.interval)
      node.interval->imu.Reintegrate({state.gyroscope_bias, state.accelerometer_bias});
  }
  for (const CameraParameters& camera : measurements.shared.cameras)
    cameras_.push_back({add(camera.extrinsics), add(camera.timing)});
  wheel_scale_ = add(std::array<double, 1>{measurements.shared.wheel_scale});
  site_from_odom_ = add(std::array<double, kSiteSize>{});
}

void DriveAdjustment::SetGnss(std::vector<AdjustedFix> fixes, const Rigid3& site_from_odom) {
  fixes_ = std::move(fixes);
  const Eigen::Vector3d forward = site_from_odom.rotation * Eigen::Vector3d::UnitX();
  site_from_odom_[0] = std::atan2(forward.y(), forward.x());
  Eigen::Map<Eigen::Vector3d>(site_from_odom_ + 1) = site_from_odom.translation;
}

void DriveAdjustment::HoldHeads(const Rig& rig) {
  for (size_t i = 0; i < rig.cameras.size(); ++i)
    for (size_t j = 0; j < rig.cameras.size(); ++j)
      if (i != j &&
          (rig.ImuFromCamera(i).translation - rig.ImuFromCamera(j).translation).norm() < kHeadSize)
        camera_priors_[i].rotation = camera_priors_[i].translation = 0;
}

void DriveAdjustment::AddPriors(const Rig& rig) {
  // Nothing measures where the drive begins and which way it heads; roll and pitch are gravity's.
  const AdjustedNode& first = nodes_.front();
  const Rigid3 odom_from_imu = PoseFromParameters(first.pose);
  Eigen::MatrixXd pose = Eigen::MatrixXd::Zero(4, kPoseTangentSize);
  pose.row(0).head<3>() =
      (odom_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ()).transpose() / kHeld;
  pose.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / kHeld;
  priors_.push_back(PriorOf({Kind::kPose, 0}, first.pose, pose));
  const std::array<double, kMotionSize> nothing{};
  Eigen::VectorXd sigmas(kMotionSize);
  sigmas << Eigen::Vector3d::Constant(kFirstVelocity),
      Eigen::Vector3d::Constant(kFirstGyroscopeBias),
      Eigen::Vector3d::Constant(kFirstAccelerometerBias);
  priors_.push_back(
      PriorOf({Kind::kMotion, 0}, nothing.data(), sigmas.cwiseInverse().asDiagonal()));
  const double no_error = 0;
  priors_.push_back(PriorOf({Kind::kWheelScale, 0}, &no_error,
                            Eigen::MatrixXd::Constant(1, 1, 1 / options_.wheel_scale_sigma)));
  for (size_t i = 0; i < cameras_.size(); ++i) {
    const CameraSigmas& sigma = camera_priors_[i];
    const auto number = static_cast<std::int64_t>(i);
    CameraParameters by_rig;
    PoseToParameters(rig.ImuFromCamera(i), by_rig.extrinsics.data());
    by_rig.timing = {0, rig.cameras[i].line_delay};
    if (sigma.rotation > 0) {
      Eigen::VectorXd extrinsics(kPoseTangentSize);
      extrinsics << Eigen::Vector3d::Constant(sigma.rotation),
          Eigen::Vector3d::Constant(sigma.translation);
      priors_.push_back(PriorOf({Kind::kExtrinsics, number}, by_rig.extrinsics.data(),
                                extrinsics.cwiseInverse().asDiagonal()));
    }
    if (sigma.time_offset > 0 || sigma.line_delay > 0) {
      const Eigen::Vector2d timing(sigma.time_offset > 0 ? sigma.time_offset : 1,
                                   sigma.line_delay > 0 ? sigma.line_delay : 1);
      priors_.push_back(PriorOf({Kind::kTiming, number}, by_rig.timing.data(),
                                timing.cwiseInverse().asDiagonal()));
    }
  }
}

void DriveAdjustment::AddImages(const DriveMeasurements& measurements) {
  const std::int64_t first_number = measurements.nodes.front().number;
  const auto index_of = [&](std::int64_t number) {
    return std::min(static_cast<size_t>(std::max<std::int64_t>(number - first_number, 0)),
                    nodes_.size() - 1);
  };
  images_.reserve(measurements.num_images());
  for (size_t i = 0; i < measurements.num_images(); ++i) {
    const RecordedImage recorded = measurements.Image(i);
    Image& image = images_.emplace_back();
    image.camera = recorded.camera;
    image.first = index_of(recorded.first_node);
    image.second = recorded.second_node ? index_of(*recorded.second_node) : image.first;
    image.angular_velocity = recorded.angular_velocity;
    const CameraSigmas& prior = camera_priors_[static_cast<size_t>(recorded.camera)];
    const CameraBlocks& camera = cameras_[static_cast<size_t>(recorded.camera)];
    ImageView& view = image.geometry;
    view.interpolation = recorded.interpolation;
    view.first_pose = nodes_[image.first].pose;
    if (image.second != image.first) view.second_pose = nodes_[image.second].pose;
    view.extrinsics = camera.extrinsics;
    view.timing = camera.timing;
    view.time_offset = recorded.time_offset;
    view.holds_time_offset = !(prior.time_offset > 0);
    view.holds_line_delay = !(prior.line_delay > 0);
  }
  PointImages();
}

void DriveAdjustment::PointImages() {
  for (Image& image : images_) {
    const Eigen::Vector3d first = Eigen::Vector3d::Map(nodes_[image.first].motion);
    const Eigen::Vector3d second = Eigen::Vector3d::Map(nodes_[image.second].motion);
    ImageView& view = image.geometry;
    view.velocity_in_odom = first + view.interpolation.fraction * (second - first);
    view.angular_velocity =
        image.angular_velocity - BiasFromParameters(nodes_[image.first].motion).gyroscope;
    view.Update();
  }
}

std::vector<double*> DriveAdjustment::BlocksOf(const Image& image) const {
  std::vector<double*> blocks{nodes_[image.first].pose};
  if (image.second != image.first) blocks.push_back(nodes_[image.second].pose);
  const CameraBlocks& camera = cameras_[static_cast<size_t>(image.camera)];
  blocks.insert(blocks.end(), {camera.extrinsics, camera.timing});
  return blocks;
}

AdjustmentStatistics DriveAdjustment::Statistics() const {
  AdjustmentStatistics statistics;
  double imu = 0;
  std::vector<double> wheels, bearings, loops, unused_loops;
  for (size_t j = 1; j < nodes_.size(); ++j) {
    const AdjustedNode &i = nodes_[j - 1], &node = nodes_[j];
    if (!node.interval) continue;
    imu += MeanSquare(ImuCost(&node.interval->imu), {i.pose, i.motion, node.pose, node.motion});
    if (node.interval->wheels && !node.interval->is_still)
      wheels.push_back(MeanSquare(WheelCost(*node.interval->wheels),
                                  {i.pose, i.motion, node.pose, wheel_scale_}));
  }
  if (nodes_.size() > 1) statistics.imu = imu / static_cast<double>(nodes_.size() - 1);
  double unused_bearings = 0;
  size_t num_unused = 0;
  for (const AdjustedLandmark& landmark : landmarks_) {
    if (!landmark.is_used) {
      unused_bearings += RobustErrorOf(landmark);
      num_unused += landmark.observations.size();
      continue;
    }
    statistics.num_landmarks += !landmark.observations.empty();
    for (const LandmarkObservation& observation : landmark.observations) {
      std::vector<double*> blocks = BlocksOf(images_[observation.image]);
      blocks.push_back(landmark.values);
      bearings.push_back(MeanSquare(*observation.cost, blocks));
    }
  }
  if (num_unused > 0)
    statistics.unused_bearings = unused_bearings / static_cast<double>(num_unused);
  for (const AdjustedLoop& loop : loops_)
    (loop.is_used ? loops : unused_loops)
        .push_back(MeanSquare(RelativePoseCost(loop.from_from_to, loop.square_root_weight),
                              {nodes_[loop.from].pose, nodes_[loop.to].pose}));
  std::vector<double> gnss;
  for (const AdjustedFix& fix : fixes_)
    gnss.push_back(
        MeanSquare(GnssCost(fix.antenna),
                   {nodes_[fix.first].pose, nodes_[fix.first + 1].pose, site_from_odom_}));
  statistics.gnss = Median(gnss);
  statistics.num_bearings = bearings.size();
  statistics.wheels = Median(wheels);
  statistics.bearings = Median(bearings);
  statistics.loops = Median(loops);
  statistics.unused_loops = Median(unused_loops);
  return statistics;
}

std::vector<MotionState> DriveAdjustment::States() const {
  std::vector<MotionState> states;
  for (const AdjustedNode& node : nodes_)
    states.push_back(StateFromParameters(node.time, node.pose, node.motion));
  return states;
}

std::vector<CameraParameters> DriveAdjustment::Cameras() const {
  std::vector<CameraParameters> cameras;
  for (const CameraBlocks& camera : cameras_) {
    std::copy_n(camera.extrinsics, kPoseSize, cameras.emplace_back().extrinsics.begin());
    std::copy_n(camera.timing, kTimingSize, cameras.back().timing.begin());
  }
  return cameras;
}

void DriveAdjustment::MoveNodes(const std::vector<Rigid3>& odom_from_odom) {
  for (size_t i = 0; i < nodes_.size(); ++i) {
    PoseToParameters(odom_from_odom[i] * PoseFromParameters(nodes_[i].pose), nodes_[i].pose);
    Eigen::Map<Eigen::Vector3d> velocity(nodes_[i].motion);
    velocity = (odom_from_odom[i].rotation * velocity).eval();
  }
  PointImages();
  for (AdjustedLandmark& landmark : landmarks_)
    if (!landmark.observations.empty()) Triangulate(landmark);
  FitLandmarks();
}

void DriveAdjustment::SetCalibration(const std::vector<CameraParameters>& cameras,
                                     double wheel_scale) {
  for (size_t i = 0; i < cameras_.size(); ++i) {
    std::copy_n(cameras[i].extrinsics.begin(), kPoseSize, cameras_[i].extrinsics);
    std::copy_n(cameras[i].timing.begin(), kTimingSize, cameras_[i].timing);
  }
  *wheel_scale_ = wheel_scale;
}

}  // namespace parkade

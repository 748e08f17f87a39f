#include "slam/refinement/drive_graph.h"

#include <gtest/gtest.h>

#include "slam/factors/measurement_model.h"
#include "slam/smoother/window_graph.h"
#include "tests/slam/worlds/noded_drive.h"

namespace parkade {
namespace {

constexpr double kWheelScale = 0.004;
constexpr int kTrack = 7;
const std::vector<int> kSeenFrom = {11, 13, 15};  // nodes with an image
const LandmarkRay kRay({0, 0, 1}, Eigen::Vector3d(1, 0.2, 0.1).normalized());
const std::array<double, kLandmarkSize> kLandmark{0.01, -0.02, 0.1};

/// A drive that stands and then rolls, of 16 nodes, a point seen from three of them: what both
/// callers of FactorGraph are given.
struct TinyDrive {
  NodedDrive drive{{.duration = 3.2, .num_cameras = 1}};
  CameraParameters camera;
  LinearPrior prior;  // of the wheel scale

  TinyDrive() {
    PoseToParameters(drive.rig().ImuFromCamera(0), camera.extrinsics.data());
    prior.blocks = {{{StateName::Kind::kWheelScale, 0}, {}}};
    prior.sqrt_information = Eigen::MatrixXd::Constant(1, 1, 1 / kWheelScaleSigma);
    prior.offset = Eigen::VectorXd::Zero(1);
  }

  Bearing BearingFrom(int node) const {
    return Bearing((Eigen::Vector3d::UnitZ() + 0.02 * node * Eigen::Vector3d::UnitX()).normalized(),
                   2e-3);
  }

  SmootherWindow Window() const {
    SmootherWindow window;
    window.cameras = {camera};
    window.camera_settings.resize(1);
    window.camera_noise_scales = {1};
    window.wheel_scale = kWheelScale;
    window.prior = prior;
    for (int i = 0; i < drive.num_nodes(); ++i) {
      StateNode& node = window.nodes.emplace_back();
      node.number = i;
      StateToParameters(drive.TruthAt(i), node.pose.data(), node.motion.data());
      if (i > 0) node.interval = drive.IntervalBefore(i);
    }
    Track& track = window.tracks[kTrack];
    track.has_landmark = true;
    track.ray = kRay;
    track.landmark = kLandmark;
    for (const int node : kSeenFrom) {
      WindowView& view = window.views.emplace_back();
      view.first_node = node;
      view.angular_velocity.setZero();
      track.observations.push_back({&view, BearingFrom(node), nullptr});
    }
    window.PointViewsAtNodes();
    for (TrackObservation& seen : track.observations)
      seen.cost = std::make_unique<BearingCost>(&seen.view->geometry, &track.ray, seen.bearing);
    return window;
  }

  std::unique_ptr<DriveMeasurements> Measurements() const {
    auto measurements = std::make_unique<DriveMeasurements>(drive.rig().imu);
    measurements->shared.cameras = {camera};
    measurements->shared.camera_priors.resize(1);
    measurements->shared.wheel_scale = kWheelScale;
    for (int i = 0; i < drive.num_nodes(); ++i)
      measurements->AddNode({i, drive.TruthAt(i)},
                            i > 0 ? std::optional(drive.IntervalBefore(i)) : std::nullopt);
    for (const int node : kSeenFrom) {
      RecordedImage image;
      image.first_node = node;
      measurements->AddImage(image);
    }
    return measurements;
  }
};

/// Adds the point and the prior of the wheel scale.
void FillDrive(const TinyDrive& tiny, AdjustedDrive& drive) {
  drive.priors.push_back(tiny.prior);
  AdjustedLandmark& landmark = drive.landmarks.emplace_back();
  landmark.ray = kRay;
  landmark.values = drive.arena.Add(kLandmark);
  for (size_t i = 0; i < kSeenFrom.size(); ++i)
    landmark.observations.push_back({i, tiny.BearingFrom(kSeenFrom[i]), nullptr});
  for (AdjustedObservation& seen : landmark.observations)
    seen.cost = std::make_unique<BearingCost>(&drive.images[seen.image].geometry, &landmark.ray,
                                              seen.bearing);
}

std::vector<MotionState> StartOf(const DriveMeasurements& measurements) {
  std::vector<MotionState> states;
  for (const RecordedNode& node : measurements.nodes) states.push_back(node.state);
  return states;
}

TEST(DriveGraph, WeighsADriveAsTheOdometrysWindowDoes) {
  const TinyDrive tiny;
  SmootherWindow window = tiny.Window();
  const std::unique_ptr<DriveMeasurements> measurements = tiny.Measurements();
  AdjustedDrive drive(*measurements, StartOf(*measurements), 1);
  FillDrive(tiny, drive);

  WindowGraph of_window(window);
  DriveGraph of_drive(drive, {0, drive.nodes.size(), false, true}, 1 / kCommonErrors);

  const double cost = of_window.Cost();
  EXPECT_GT(cost, 1);
  EXPECT_NEAR(of_drive.graph().Cost(), cost, 1e-9 * cost);
}

TEST(DriveGraph, AnOpenEndLeavesOutWhatHangsOnLaterNodes) {
  const TinyDrive tiny;
  const std::unique_ptr<DriveMeasurements> measurements = tiny.Measurements();
  AdjustedDrive drive(*measurements, StartOf(*measurements), 1);
  FillDrive(tiny, drive);

  DriveGraph open(drive, {0, 12, true, true}, 1), closed(drive, {0, 12, false, true}, 1);

  EXPECT_FALSE(open.graph().Contains(drive.nodes[12].pose));
  EXPECT_TRUE(closed.graph().Contains(drive.nodes[12].pose));
  EXPECT_TRUE(closed.graph().problem().IsParameterBlockConstant(drive.nodes[12].pose));
  EXPECT_FALSE(closed.graph().problem().IsParameterBlockConstant(drive.nodes[11].pose));
  EXPECT_EQ(open.graph().landmarks().size(), 0u) << "seen once before the end";
  EXPECT_EQ(closed.graph().landmarks().size(), 1u);
}

}  // namespace
}  // namespace parkade

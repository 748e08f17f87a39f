#pragma once

#include <memory>
#include <vector>

#include "slam/factors/sample_buffer.h"
#include "slam/smoother/drive_measurements.h"
#include "slam/smoother/fixed_lag_smoother.h"
#include "tests/support/sampled_drive.h"

namespace parkade {

/// A synthetic car drive cut into nodes at even times, with the truth at each: for tests of what
/// lies behind the odometry that would choose them.
class NodedDrive {
 public:
  explicit NodedDrive(const SampledDriveOptions& options)
      : options_(options),
        drive_(MakeCarDrive(options)),
        motion_(CarMotion(options.start + options.duration)) {
    for (const ImuSample& sample : drive_.imu) imu_.Add(sample);
    for (const WheelSample& sample : drive_.wheels) wheels_.Add(sample);
  }

  const Rig& rig() const { return drive_.rig; }
  /// Numbered from 0.
  int num_nodes() const { return static_cast<int>(options_.duration / kInterval); }

  MotionState TruthAt(int node) const {
    const BodyMotion body = motion_(options_.start + kInterval * node);
    const Rigid3& body_from_imu = drive_.rig.body_from_imu;
    MotionState state;
    state.time = TimeAt(node);
    state.odom_from_imu = body.world_from_body * body_from_imu;
    state.velocity_in_odom =
        body.velocity +
        body.world_from_body.rotation * body.angular_velocity.cross(body_from_imu.translation);
    return state;
  }

  NodeInterval IntervalBefore(int node, const ImuBias& bias = {}) const {
    const Timestamp begin = TimeAt(node - 1), end = TimeAt(node);
    NodeInterval interval{ImuPreintegration(imu_.Between(begin, end), bias, drive_.rig.imu), {}};
    interval.is_still = motion_(options_.start + kInterval * node).velocity.norm() == 0;
    if (!interval.is_still && !wheels_.empty())
      interval.wheels = PreintegrateWheels(interval.imu.samples(), wheels_.Between(begin, end),
                                           bias.gyroscope, drive_.rig.body_from_imu.Inverse(), {});
    return interval;
  }

  /// The last image of each camera within the interval before a node.
  std::vector<NewImage> ImagesBefore(int node, const NodeInterval& interval,
                                     const Eigen::Quaterniond& odom_from_first) const {
    std::vector<const TrackedFrame*> last(drive_.rig.cameras.size(), nullptr);
    for (const TrackedFrame& frame : drive_.frames)
      if (TimeAt(node - 1) < frame.time && frame.time < TimeAt(node))
        last[static_cast<size_t>(frame.camera)] = &frame;
    std::vector<NewImage> images;
    for (const TrackedFrame* frame : last) {
      if (!frame) continue;
      const MotionIncrement part =
          Integrate(imu_.Between(interval.imu.begin(), frame->time), interval.imu.bias());
      images.push_back({*frame,
                        MakeNodeInterpolation(part, interval.imu.increment(), odom_from_first),
                        imu_.At(frame->time).angular_velocity});
    }
    return images;
  }

  /// What odometry would record of the drive, with intervals and images as from the truth.
  std::unique_ptr<DriveMeasurements> Measure() const {
    FixedLagSmoother smoother(rig(), {});
    auto measurements = std::make_unique<DriveMeasurements>(rig().imu);
    smoother.Start(TruthAt(0), {}, {});
    measurements->AddNode({0, TruthAt(0)}, std::optional<NodeInterval>());
    for (int node = 1; node < num_nodes(); ++node) {
      NodeInterval interval = IntervalBefore(node);
      measurements->AddNode({node, TruthAt(node)}, interval);
      std::vector<NewImage> images =
          ImagesBefore(node, interval, TruthAt(node - 1).odom_from_imu.rotation);
      smoother.AddNode(std::move(interval), std::move(images));
    }
    for (RecordedImage& image : smoother.TakeImages()) measurements->AddImage(std::move(image));
    SharedFindings& shared = measurements->shared;
    shared.cameras = smoother.cameras();
    for (const CameraSettings& settings : smoother.camera_settings())
      shared.camera_priors.push_back(settings.prior);
    shared.camera_noise_scales = smoother.camera_noise_scales();
    return measurements;
  }

 private:
  static constexpr double kInterval = 0.2;  // [s] between nodes
  Timestamp TimeAt(int node) const { return drive_.imu.front().time + kInterval * node; }

  SampledDriveOptions options_;
  SampledDrive drive_;
  MotionFunction motion_;
  ImuBuffer imu_;
  WheelBuffer wheels_;
};

}  // namespace parkade

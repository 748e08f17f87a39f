#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"
#include "tests/mapping/worlds/synthetic_scene.h"

namespace parkade {

/// Four fisheye cameras around a car (front, rear, left, right), with or without vehicle.yaml's
/// values. Without, the body is an IMU frame 0.6 m above the road.
Rig MakeTestRig(bool has_vehicle = true, int width = 320, int height = 200);

/// One bend or straight of a path: `curvature` [1/m], positive to the left.
struct PathPiece {
  double length = 0;
  double curvature = 0;
};

/// site_from_body at 50 Hz along the pieces at 4 m/s, all wheels on the scene's ground.
Trajectory DriveAlong(const SyntheticScene& scene, const Eigen::Vector3d& start, double yaw,
                      const std::vector<PathPiece>& pieces, const Rig& rig);

/// A drive log in memory: images are rendered when they are asked for.
class SyntheticDrive : public DriveLog {
 public:
  SyntheticDrive(SyntheticScene scene, Rig rig, Trajectory site_from_body, bool has_masks,
                 double rate = 10);

  const std::string& name() const override { return name_; }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override { return trajectory_.span(); }
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override;

  /// Image and mask of a camera at a time of the trajectory.
  std::pair<cv::Mat, cv::Mat> Render(int camera, Timestamp time) const;
  const SyntheticScene& scene() const { return scene_; }
  const Trajectory& trajectory() const { return trajectory_; }
  double rate() const { return rate_; }
  bool has_masks() const { return has_masks_; }

 private:
  std::string name_ = "synthetic";
  SyntheticScene scene_;
  Rig rig_;
  Trajectory trajectory_;
  bool has_masks_;
  double rate_;
  std::vector<std::vector<Eigen::Vector3d>>
      rays_;  ///< unit bearings by camera and pixel; zero where none
};

}  // namespace parkade

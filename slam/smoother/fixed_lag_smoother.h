#pragma once

#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "core/rig.h"
#include "slam/factors/linear_prior.h"
#include "slam/smoother/drive_measurements.h"
#include "slam/smoother/node_conditional.h"
#include "slam/smoother/smoother_options.h"
#include "slam/smoother/smoother_window.h"
#include "slam/smoother/standstill_cost.h"

namespace parkade {

/// What of one camera's calibration is estimated, and what was known of it before.
struct CameraSettings {
  double middle_row = 0;  ///< [px]
  CameraSigmas prior;
  bool has_extrinsics = true;   ///< estimated
  bool has_time_offset = true;  ///< estimated
  bool has_line_delay = false;  ///< estimated
};

/// A camera whose mount turned at once.
struct CameraJump {
  Timestamp time;  ///< of its first image after that
  int camera = 0;
  double angle = 0;  ///< [rad]
};

/// What one solve was like, for reports and tests.
struct SolveSummary {
  int iterations = 0;
  double seconds = 0;
  double final_cost = 0;
  int landmarks = 0;
  int bearings = 0;
};

/// Fixed-lag smoother: the states of the last nodes, the landmarks in their
/// images, the wheel scale and the calibration of the cameras, estimated together
/// from IMU, wheels, standstill and bearings; what leaves the window is condensed into a linear
/// prior. Deterministic; one thread.
///
/// S. Leutenegger et al., "Keyframe-based visual-inertial odometry using
/// nonlinear optimization", IJRR 2015; N. Demmel et al., ICCV 2021 (prior).
class FixedLagSmoother {
 public:
  FixedLagSmoother(const Rig& rig, const SmootherOptions& options);

  /// Begins with one node. Images at exactly its time may come with it.
  void Start(const MotionState& first, const StartUncertainty& uncertainty,
             std::vector<NewImage> images);

  /// Appends a node at the end of `interval`, predicted by the IMU, with the
  /// images of the interval. Does not solve.
  void AddNode(NodeInterval interval, std::vector<NewImage> images);

  SolveSummary Solve();

  /// Removes the oldest node while there are more than `window_nodes`.
  std::vector<FinishedNode> DropOldest();
  /// Removes all nodes but the last, which it copies. Last but for LastEstimate.
  std::vector<FinishedNode> Finish();
  /// After Finish: the last node, the wheel scale and the cameras, with their covariance.
  JointEstimate LastEstimate() const;
  /// Landmarks that left the window since the last call.
  std::vector<FinishedLandmark> TakeLandmarks();
  /// Images that came since the last call, for whoever adjusts the whole drive.
  std::vector<RecordedImage> TakeImages() { return std::exchange(recorded_images_, {}); }

  const std::deque<StateNode>& nodes() const { return nodes_; }
  MotionState Latest() const { return nodes_.back().State(); }
  double wheel_scale() const { return wheel_scale_; }
  /// What is known of the cameras now; and how well, by the prior (the window's images not
  /// counted).
  const std::vector<CameraParameters>& cameras() const { return cameras_; }
  CameraSigmas SigmasOf(int camera) const;
  const std::vector<CameraSettings>& camera_settings() const { return camera_settings_; }
  /// Cameras whose mounts turned, in order of time.
  const std::vector<CameraJump>& jumps() const { return jumps_; }
  /// Noise found / noise declared, per camera.
  const std::vector<double>& camera_noise_scales() const { return camera_noise_scales_; }
  int NumLandmarks() const;

 private:
  void AddCameras(const Rig& rig);
  void AddPriorOfCameras();
  void AddPriorOfPair(size_t i, size_t j);
  void AddImages(std::vector<NewImage> images, std::int64_t node_before, std::int64_t node_at);
  Bearing BearingOf(const FeatureObservation& seen, int camera) const;
  void LookForJumps(size_t first_new_view);
  void RotateCamera(const WindowView& first_view, const Eigen::Quaterniond& new_from_old);
  void ReopenExtrinsics(int camera, const Eigen::Quaterniond& new_from_old,
                        const CameraSigmas& sigmas);
  void StartLandmarks();
  bool StartLandmark(Track& track);
  void PointViewsAtNodes();
  void RejectOutliers();
  bool RejectOutliersOf(Track& track);
  void UpdateCameraNoise();
  void Restart(Track& track);
  FinishedNode MarginalizeOldest();
  void ForgetOldest();
  void FinishLandmark(const Track& track);
  SolveSummary SolveWindow(int max_iterations);
  /// The states that bearings in `view` depend on, in the order of their blocks.
  static std::vector<StateName> StatesOf(const WindowView& view);
  bool IsEstimated(const StateName& name) const;
  const double* ValuesOf(const StateName& name) const;
  void UpdateOldestCovariance();
  StateNode& NodeNumbered(std::int64_t number) {
    return nodes_[static_cast<size_t>(number - nodes_.front().number)];
  }
  const StateNode& NodeNumbered(std::int64_t number) const {
    return nodes_[static_cast<size_t>(number - nodes_.front().number)];
  }

  SmootherOptions options_;
  std::vector<CameraParameters> cameras_;
  std::vector<CameraSettings> camera_settings_;
  std::deque<StateNode> nodes_;
  std::deque<WindowView> views_;          ///< in order of their first node
  std::map<std::int64_t, Track> tracks_;  ///< by number: the order of everything that follows
  LinearPrior prior_;
  std::vector<StateConditional> reopened_;  ///< since the last node that left
  double wheel_scale_ = 0;
  std::vector<CameraJump> jumps_;
  std::vector<double> camera_noise_scales_;
  std::vector<FinishedLandmark> finished_landmarks_;
  std::vector<RecordedImage> recorded_images_;
  Eigen::Matrix<double, 6, 6> oldest_covariance_ = Eigen::Matrix<double, 6, 6>::Zero();
  bool has_been_full_ = false;
};

}  // namespace parkade

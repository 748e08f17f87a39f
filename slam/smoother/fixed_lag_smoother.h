#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "core/rig.h"
#include "slam/factors/factor_graph.h"
#include "slam/smoother/mount_jumps.h"
#include "slam/smoother/node_conditional.h"
#include "slam/smoother/recorded_states.h"
#include "slam/smoother/smoother_options.h"
#include "slam/smoother/smoother_window.h"

namespace parkade {

/// Fixed-lag smoother: what a window of nodes holds, how often it is solved, and when a node leaves
/// it. The window is estimated from IMU, wheels, standstill and bearings (WindowGraph); what leaves
/// it is condensed into a linear prior (MarginalizeOldest). Deterministic; one thread.
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

  const SmootherWindow& window() const { return window_; }
  const std::deque<StateNode>& nodes() const { return window_.nodes; }
  MotionState Latest() const { return window_.nodes.back().State(); }
  double wheel_scale() const { return window_.wheel_scale; }
  /// What is known of the cameras now.
  const std::vector<CameraParameters>& cameras() const { return window_.cameras; }
  const std::vector<CameraSettings>& camera_settings() const { return window_.camera_settings; }
  /// Cameras whose mounts turned, in order of time.
  const std::vector<CameraJump>& jumps() const { return jumps_; }
  /// Noise found / noise declared, per camera.
  const std::vector<double>& camera_noise_scales() const { return window_.camera_noise_scales; }

 private:
  void AddImages(std::vector<NewImage> images, std::int64_t node_before, std::int64_t node_at);
  void AddView(const NewImage& image, std::int64_t node_before, std::int64_t node_at);
  void AddObservations(const NewImage& image, WindowView& view);
  void LookForJumps(size_t first_new_view);
  FinishedNode RemoveOldest();

  SmootherOptions options_;
  SmootherWindow window_;
  std::vector<StateConditional> reopened_;  ///< since the last node that left
  std::vector<CameraJump> jumps_;
  std::vector<FinishedLandmark> finished_landmarks_;
  std::vector<RecordedImage> recorded_images_;
  Eigen::Matrix<double, 6, 6> oldest_covariance_ = Eigen::Matrix<double, 6, 6>::Zero();
  bool has_been_full_ = false;
};

}  // namespace parkade

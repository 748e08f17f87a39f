#pragma once

#include <deque>
#include <map>
#include <vector>

#include "core/rig.h"
#include "slam/linear_prior.h"
#include "slam/smoother_options.h"
#include "slam/smoother_window.h"
#include "slam/standstill_cost.h"

namespace parkade {

/// How well the first state is known: standard deviations. Yaw and position
/// are the choice of the odom frame, hence exact.
struct StartUncertainty {
  double tilt = 0.05;               ///< [rad]
  double velocity = 0.2;            ///< [m/s]
  double gyroscope_bias = 0.02;     ///< [rad/s]
  double accelerometer_bias = 0.1;  ///< [m/s^2]
};

/// What one solve was like, for reports and tests.
struct SolveSummary {
  int iterations = 0;
  double seconds = 0;
  double final_cost = 0;
  int landmarks = 0;
  int bearings = 0;
};

/// Fixed-lag smoother: the states of the last knots, the landmarks in their
/// images and the wheel scale, estimated together from IMU, wheels, standstill
/// and bearings; what leaves the window is condensed into a linear prior with
/// first-estimate Jacobians. Deterministic; one thread.
///
/// S. Leutenegger et al., "Keyframe-based visual-inertial odometry using
/// nonlinear optimization", IJRR 2015; N. Demmel et al., ICCV 2021 (prior).
class FixedLagSmoother {
 public:
  FixedLagSmoother(const Rig& rig, const SmootherOptions& options);

  /// Begins with one knot. Images at exactly its time may come with it.
  void Start(const MotionState& first, const StartUncertainty& uncertainty, std::vector<NewImage> images);

  /// Appends a knot at the end of `interval`, predicted by the IMU, with the
  /// images of the interval. Does not solve.
  void AddKnot(KnotInterval interval, std::vector<NewImage> images);

  SolveSummary Solve();

  /// Removes the oldest knot while there are more than `window_knots`.
  std::vector<FinishedKnot> DropOldest();
  /// Removes all knots.
  std::vector<FinishedKnot> Finish();
  /// After Finish: covariance of the last knot's [pose, motion] and the wheel scale, 16 x 16.
  Eigen::MatrixXd LastCovariance() const;
  /// Landmarks that left the window since the last call.
  std::vector<FinishedLandmark> TakeLandmarks();

  const std::deque<Knot>& knots() const { return knots_; }
  MotionState Latest() const { return knots_.back().State(); }
  double wheel_scale() const { return wheel_scale_; }
  /// Noise found / noise declared, per camera.
  const std::vector<double>& camera_noise_scales() const { return camera_noise_scales_; }
  int NumLandmarks() const;

 private:
  void AddImages(std::vector<NewImage> images, std::int64_t knot_before, std::int64_t knot_at);
  void StartLandmarks();
  bool StartLandmark(Track& track);
  void PointViewsAtKnots();
  void RejectOutliers();
  bool RejectOutliersOf(Track& track);
  void UpdateCameraNoise();
  void Restart(Track& track);
  FinishedKnot MarginaliseOldest();
  void ForgetOldest();
  void FinishLandmark(const Track& track);
  SolveSummary SolveWindow(int max_iterations);
  void UpdateOldestCovariance();
  Knot& KnotNumbered(std::int64_t number) { return knots_[static_cast<size_t>(number - knots_.front().number)]; }

  std::vector<Rigid3> imu_from_camera_;
  SmootherOptions options_;
  std::deque<Knot> knots_;
  std::deque<WindowView> views_;          ///< in order of their first knot
  std::map<std::int64_t, Track> tracks_;  ///< by number: the order of everything that follows
  LinearPrior prior_;
  double wheel_scale_ = 0;
  std::vector<double> camera_noise_scales_;
  std::vector<FinishedLandmark> finished_landmarks_;
  Eigen::Matrix<double, 6, 6> oldest_covariance_ = Eigen::Matrix<double, 6, 6>::Zero();
  bool has_been_full_ = false;
};

}  // namespace parkade

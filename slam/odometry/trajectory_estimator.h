#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "slam/initialization/start_motion.h"
#include "slam/odometry/early_records.h"
#include "slam/odometry/odometry_options.h"
#include "slam/odometry/odometry_result.h"
#include "slam/odometry/trajectory_builder.h"
#include "slam/smoother/fixed_lag_smoother.h"

namespace parkade {

/// Visual-inertial(-wheel) odometry from samples and tracked frames: waits until
/// it can start, places nodes, feeds the smoother and collects the result. It sees no images.
///
/// Records come in order of time over all sensors; late, repeated or
/// non-finite ones are skipped. Deterministic; one thread.
class TrajectoryEstimator {
 public:
  TrajectoryEstimator(const Rig& rig, const OdometryOptions& options);

  /// Begins at a known state instead of looking for a start. Before any record.
  void BeginFrom(const MotionState& state, const StartUncertainty& uncertainty);

  void Add(const ImuSample& sample);
  void Add(const WheelSample& sample);
  void Add(TrackedFrame frame);

  /// The whole trajectory. Throws Error{kInvalidInput} with one sentence when the
  /// data never allowed a start. Call once, last.
  OdometryResult Finish();

  /// The latest state so far, to predict images by; nothing before the start.
  std::optional<MotionState> Latest() const;
  /// Where the cameras sit, as far as it is known by now.
  std::vector<Rigid3> ImuFromCameras() const;

 private:
  void Advance();
  void TryStart(bool is_last_chance);
  std::optional<StartEstimate> AttemptStart(Timestamp begin, Timestamp now,
                                            bool is_last_chance) const;
  void Begin(const StartEstimate& start);
  void PlaceNodes(Timestamp until);
  Timestamp SnapToImage(Timestamp time) const;
  double NextInterval() const;
  void MakeNode(Timestamp time, bool is_still);
  std::vector<NewImage> TakeImages(const ImuPreintegration& imu);
  void SolveAndCollect();
  void Collect(std::vector<FinishedNode> finished);
  void NoteDegradation(Timestamp begin, Timestamp end, int bearings_seen, bool has_wheels);
  void AddDegraded(Timestamp begin, Timestamp end, const std::string& reason);
  void BuildTrajectory(OdometryResult& result);
  void TakeMeasurements(OdometryResult& result);
  /// The states from the first IMU sample up to after_start_, in order of time; empty where there
  /// is nothing
  /// before it.
  std::vector<TrajectoryState> RunBackwards(const Rig& refined) const;
  void FillBeforeStart(const Rig& refined, std::vector<TrajectoryState>& states);
  bool IsEarly(Timestamp time) const;
  void SelectKeyframes(OdometryResult& result) const;
  void FinishReport();
  void FinishCalibration(const JointEstimate& last, OdometryResult& result);

  Rig rig_;
  OdometryOptions options_;
  ImuBuffer imu_;
  WheelBuffer wheels_;
  std::deque<TrackedFrame> pending_;  ///< frames later than the last node
  StandstillDetector standstill_;
  FixedLagSmoother smoother_;
  TrajectoryBuilder builder_;

  bool is_started_ = false;
  bool is_start_still_ = false;
  Timestamp start_search_;  ///< attempts to start begin here
  std::optional<Timestamp> next_attempt_;
  static constexpr double kOverlap =
      1.0;               ///< [s] after the first node from which the time before is run backwards
  EarlyRecords early_;   ///< up to a little after the first node
  Timestamp log_begin_;  ///< first IMU sample
  Timestamp first_node_;
  std::optional<MotionState> after_start_;  ///< a finished state, a little after the first node
  Timestamp last_node_, last_cut_;
  Timestamp surely_moving_until_;
  bool is_run_still_ = false;  ///< since the last node

  struct UsedImage {
    Timestamp time;  ///< as the log says, no offset estimated here
    int camera;
  };
  std::vector<UsedImage> used_images_;
  std::vector<Timestamp> last_frame_;      ///< per camera
  std::vector<std::int64_t> tracks_seen_;  ///< per camera, in frames used
  std::shared_ptr<DriveMeasurements>
      measurements_;               ///< from nodes that left the window, and from all images
  ConditionalStore conditionals_;  ///< from the same nodes
  std::vector<FinishedLandmark> landmarks_;
  OdometryReport report_;
  double sum_bearings_ = 0;
  double sum_solve_seconds_ = 0;
};

}  // namespace parkade

#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/rigid3.h"
#include "core/trajectory.h"

namespace parkade {

struct EvaluationOptions {
  /// [s] The truth is interpolated between two of its poses at most this far
  /// apart; an estimate in a longer hole of the truth is not matched.
  double max_truth_gap = 1.0;
  std::vector<double> segment_lengths = {1, 10, 50, 100};  ///< [m] for relative errors

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("max_truth_gap", max_truth_gap);
    visit("segment_lengths", segment_lengths);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Statistics of non-negative errors; all 0 without any.
struct ErrorSummary {
  double rmse = 0, mean = 0, median = 0, max = 0;
};

/// Absolute error after the estimate was moved as a whole onto the truth.
struct AbsoluteError {
  Rigid3 truth_from_estimate;  ///< the alignment, from the estimate's world to the truth's
  ErrorSummary translation;    ///< [m]
  ErrorSummary rotation;       ///< [rad] of the attitude that remains
};

/// Error of the motion over stretches of the drive. Needs no alignment.
struct RelativeError {
  double length = 0;         ///< [m] of a stretch (along the truth), or [s] where told
  std::size_t count = 0;     ///< stretches found; 0: the drive is shorter
  ErrorSummary translation;  ///< [m] per stretch
  ErrorSummary rotation;     ///< [rad] per stretch
};

struct TrajectoryEvaluation {
  std::size_t num_estimates = 0;
  std::size_t num_matched = 0;  ///< estimates with a truth at their time
  double path_length = 0;       ///< [m] of the truth, over the matched times
  double duration = 0;          ///< [s] from the first match to the last
  AbsoluteError rigid;          ///< ATE after 6-DoF alignment, the usual figure
  AbsoluteError yaw_only;       ///< the same with yaw and translation only: both worlds have z up
  AbsoluteError by_poses;  ///< after 6-DoF alignment of attitudes, too: what lies beside the drive
  double tilt = 0;         ///< [rad] between the two verticals in that alignment
  double drift_percent = 0;  ///< 100 * rigid.translation.rmse / path_length; 0 at standstill
  double scale = 1;          ///< of the estimate, from a 7-DoF alignment: diagnostic, never applied
  std::vector<RelativeError> per_length;  ///< one per EvaluationOptions::segment_lengths
  RelativeError per_second;               ///< stretches of 1 s
};

/// Compares an estimated trajectory with the truth. Both must be poses of the
/// same frame of the car; their worlds may differ. Association: the truth is
/// interpolated (geodesic) at each estimate's time; estimates outside of the
/// truth or in its holes are counted, not compared.
///
/// Alignment without scale: S. Umeyama, "Least-squares estimation of
/// transformation parameters between two point patterns", TPAMI 1991, eq. 40-42.
/// Alignment by poses: the same for each pose's position and three points 5 m off along its axes,
/// since positions along a straight street leave the roll about it open. Relative error: J. Sturm
/// et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012, eq. 2.
///
/// Throws Error{kInvalidInput} when fewer than 3 estimates have a truth, or the
/// times of either list do not increase. O(n log n).
TrajectoryEvaluation EvaluateTrajectory(const std::vector<TimedPose>& truth,
                                        const std::vector<TimedPose>& estimate,
                                        const EvaluationOptions& options = {});

/// A few aligned lines for people.
std::string ToText(const TrajectoryEvaluation& evaluation);

/// Every field under its own name; quaternions as [x, y, z, w].
nlohmann::json ToJson(const TrajectoryEvaluation& evaluation);

/// Poses of `frame` as those of another frame of the car:
/// world_from_other = world_from_frame * frame_from_other.
std::vector<TimedPose> PosesOf(const std::vector<TimedPose>& world_from_frame,
                               const Rigid3& frame_from_other);

/// The poses of a trajectory, for evaluation and WriteTum.
std::vector<TimedPose> ToTimedPoses(const Trajectory& trajectory);

}  // namespace parkade

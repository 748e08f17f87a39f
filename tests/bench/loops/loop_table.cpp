#include "tests/bench/loops/loop_table.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "slam/evaluation/evaluate_trajectory.h"
#include "slam/odometry/calibrated_log.h"
#include "slam/odometry/estimate_trajectory.h"
#include "slam/odometry/odometry_file.h"
#include "tests/bench/suite/rerigged_log.h"

namespace parkade {
namespace {

constexpr double kWrongTranslation = 1.0;          // [m] off: another place
constexpr double kWrongRotation = 5 * M_PI / 180;  // [rad]
constexpr double kSameSpot = 3.0;                  // [m] between two visits that could be a loop
constexpr double kSameDeck = 1.0;                  // [m]
constexpr double kOpposite = 135 * M_PI / 180;     // [rad] between headings

/// Poses of the true drive at any time.
class Truth {
 public:
  Truth(const SuiteDrive& drive) : imu_from_body_(drive.true_rig.body_from_imu.Inverse()) {
    std::vector<TrajectoryState> states;
    for (const TimedPose& pose : drive.world_from_imu) {
      TrajectoryState state;
      state.time = pose.time;
      state.world_from_body = pose.world_from_frame * imu_from_body_;
      states.push_back(state);
    }
    trajectory_ = Trajectory(std::move(states));
  }

  std::optional<Rigid3> KeyframeAt(Timestamp time) const {
    const std::optional<Rigid3> body = trajectory_.At(time);
    return body ? std::optional(LeveledPose(*body)) : std::nullopt;
  }

 private:
  Rigid3 imu_from_body_;
  Trajectory trajectory_;
};

void Evaluate(const SuiteDrive& drive, const Rig& rig, const Trajectory& odom_from_body,
              LoopRun& run) {
  const TrajectoryEvaluation error = EvaluateTrajectory(
      drive.world_from_imu, PosesOf(ToTimedPoses(odom_from_body), rig.body_from_imu));
  run.ate = error.rigid.translation.rmse;
  run.drift_percent = error.drift_percent;
  run.length = error.path_length;
}

MountError MountErrorOf(const Rig& rig, const Rig& true_rig) {
  MountError worst;
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    const Rigid3 off = true_rig.ImuFromCamera(i).Inverse() * rig.ImuFromCamera(i);
    worst.rotation =
        std::max(worst.rotation, off.rotation.angularDistance(Eigen::Quaterniond::Identity()));
    worst.translation = std::max(worst.translation, off.translation.norm());
  }
  return worst;
}

bool IsOpposite(const Rigid3& a, const Rigid3& b) {
  return a.rotation.angularDistance(b.rotation) > kOpposite;
}

void CountOpposite(const Truth& truth, const Trajectory& odometry, const LoopOptions& options,
                   LoopRun& run, const LoopClosure& closure) {
  const std::vector<RigKeyframe> keyframes = ChooseKeyframes(odometry, options.keyframes);
  for (const RigKeyframe& later : keyframes) {
    const std::optional<Rigid3> now = truth.KeyframeAt(later.time);
    const bool is_chance =
        now && std::any_of(keyframes.begin(), keyframes.end(), [&](const RigKeyframe& earlier) {
          if (later.distance - earlier.distance < options.recognition.min_gap) return false;
          const std::optional<Rigid3> then = truth.KeyframeAt(earlier.time);
          const Eigen::Vector3d apart = then ? Eigen::Vector3d(then->translation - now->translation)
                                             : Eigen::Vector3d(1e9, 0, 0);
          return apart.head<2>().norm() < kSameSpot && std::abs(apart.z()) < kSameDeck &&
                 IsOpposite(*then, *now);
        });
    if (!is_chance) continue;
    ++run.num_opposite_chances;
    run.num_opposite_found +=
        std::any_of(closure.loops.begin(), closure.loops.end(), [&](const LoopEvidence& loop) {
          if (loop.weight <= 0.5 || loop.later != later.time) return false;
          const std::optional<Rigid3> then = truth.KeyframeAt(loop.earlier);
          return then && IsOpposite(*then, *now);
        });
  }
}

/// The error of a loop where it was measured, in the units of its own information.
void JudgeClaim(const LoopEvidence& loop, const Rigid3& earlier_from_later, LoopError& judged) {
  PoseGraphEdge edge;
  edge.from_from_to =
      loop.earlier_from_camera.Inverse() * loop.pose.a_from_b * loop.later_from_camera;
  judged.error = RelativePoseError(edge, loop.earlier_from_camera,
                                   earlier_from_later * loop.later_from_camera);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(loop.pose.information);
  const Vector6d eigenvalues = solver.eigenvalues();
  const auto is_known = eigenvalues.array() > 1e-9 * eigenvalues.maxCoeff();
  const Vector6d variances = is_known.select(eigenvalues.cwiseInverse(), 0);
  judged.sigmas =
      (solver.eigenvectors() * variances.asDiagonal() * solver.eigenvectors().transpose())
          .diagonal()
          .cwiseSqrt();
  judged.squared = judged.error.dot(loop.pose.information * judged.error) /
                   static_cast<double>(is_known.count());
}

void JudgeLoops(const Truth& truth, const LoopClosure& closure, LoopRun& run) {
  const Timestamp odometry_begin = closure.odom_from_body.states().front().time;
  run.num_candidates = static_cast<int>(closure.loops.size());
  for (const LoopEvidence& loop : closure.loops) {
    run.num_measured += loop.pose.rejected.empty();
    const std::optional<Rigid3> earlier = truth.KeyframeAt(loop.earlier),
                                later = truth.KeyframeAt(loop.later);
    if (loop.weight <= 0.5 || !earlier || !later) continue;
    const Rigid3 actual = earlier->Inverse() * *later;
    const Rigid3 error = actual.Inverse() * loop.pose.a_from_b;
    LoopError& judged = run.accepted.emplace_back();
    judged.translation = error.translation.norm();
    judged.rotation = error.rotation.angularDistance(Eigen::Quaterniond::Identity());
    JudgeClaim(loop, actual, judged);
    judged.earlier = loop.earlier - odometry_begin;
    judged.later = loop.later - odometry_begin;
    judged.num_inliers = loop.pose.num_inliers;
    judged.is_opposite = IsOpposite(*earlier, *later);
    judged.height = actual.translation.z();
    run.num_wrong += judged.translation > kWrongTranslation || judged.rotation > kWrongRotation;
  }
}

}  // namespace

TrackedDrive TrackDrive(const SuiteDrive& drive, const TableVariant& variant,
                        const OdometryOptions& options, const std::filesystem::path& kept) {
  TrackedDrive tracked;
  tracked.log =
      std::make_unique<ReriggedLog>(*drive.log, RigOfVariant(variant, drive), std::vector<int>{});
  if (!kept.empty() && std::filesystem::exists(kept)) {
    tracked.odometry = ReadOdometry(kept, tracked.log->rig());
    return tracked;
  }
  OdometryOptions odometry = options;
  odometry.use_wheels = variant.has_wheels;
  tracked.odometry = EstimateTrajectory(*tracked.log, odometry);
  if (!kept.empty()) WriteOdometry(tracked.odometry, tracked.log->rig(), kept);
  return tracked;
}

std::vector<LoopRun> RunLoops(const SuiteDrive& drive, const TrackedDrive& tracked,
                              const std::vector<std::string>& methods,
                              const LoopTableOptions& table_options) {
  const OdometryResult& odometry = tracked.odometry;
  const DriveLog& log = *tracked.log;
  const CalibratedLog calibrated(log, odometry.rig);
  const Truth truth(drive);
  std::vector<LoopRun> runs;
  for (const std::string& method : methods) {
    LoopOptions options = table_options.loops;
    options.method = method;
    KeyframeStore described;
    const LoopClosure closure =
        CloseLoops(calibrated, odometry.odom_from_body, options, {}, described);
    LoopRun& run = runs.emplace_back();
    run.drive = drive.name;
    run.scene = drive.scene;
    run.method = method;
    run.odometry_seconds = odometry.report.seconds;
    run.mount_error = MountErrorOf(odometry.rig, drive.true_rig_at_end);
    run.drift = DriftOf(odometry.odom_from_body);
    run.duration = log.span().Seconds();
    run.seconds = closure.seconds;
    Evaluate(drive, log.rig(), closure.odom_from_body, run);
    JudgeLoops(truth, closure, run);
    CountOpposite(truth, odometry.odom_from_body, options, run, closure);
    if (method != "rig" && method != "none") continue;
    if (method == "rig" && table_options.wrong.share > 0) {
      run.mixed = MixInWrongLoops(odometry.odom_from_body, closure, options, table_options.wrong);
      LoopRun mixed;
      Evaluate(drive, log.rig(), run.mixed.odom_from_body, mixed);
      run.mixed_ate = mixed.ate;
    }
    if (!table_options.refines) continue;
    LoopRun refined = run;
    refined.method = method + "+refine";
    refined.refinement = RefineDrive(odometry, log.rig(), closure, table_options.refinement,
                                     table_options.uses_gnss ? ReadGnss(log, {}) : GnssPositions{});
    refined.mount_error = MountErrorOf(refined.refinement.rig, drive.true_rig_at_end);
    refined.seconds = refined.refinement.seconds;
    Evaluate(drive, log.rig(), refined.refinement.odom_from_body, refined);
    runs.push_back(std::move(refined));
  }
  return runs;
}

nlohmann::json ToJson(const LoopRun& run) {
  nlohmann::json accepted = nlohmann::json::array();
  for (const LoopError& error : run.accepted)
    accepted.push_back({{"translation", error.translation},
                        {"rotation", error.rotation},
                        {"squared", error.squared},
                        {"error", std::vector<double>(error.error.begin(), error.error.end())},
                        {"sigmas", std::vector<double>(error.sigmas.begin(), error.sigmas.end())},
                        {"earlier", error.earlier},
                        {"later", error.later},
                        {"num_inliers", error.num_inliers},
                        {"is_opposite", error.is_opposite},
                        {"height", error.height}});
  nlohmann::json json = {
      {"drive", run.drive},
      {"scene", run.scene},
      {"method", run.method},
      {"length", run.length},
      {"duration", run.duration},
      {"ate", run.ate},
      {"drift_percent", run.drift_percent},
      {"num_candidates", run.num_candidates},
      {"num_measured", run.num_measured},
      {"num_wrong", run.num_wrong},
      {"num_opposite_chances", run.num_opposite_chances},
      {"num_opposite_found", run.num_opposite_found},
      {"seconds", run.seconds},
      {"odometry_seconds", run.odometry_seconds},
      {"mount_error",
       {{"rotation", run.mount_error.rotation}, {"translation", run.mount_error.translation}}},
      {"odometry_drift", {{"translation", run.drift.translation}, {"yaw", run.drift.yaw}}},
      {"accepted", accepted}};
  if (run.mixed.num_wrong > 0)
    json["mixed"] = {{"num_right", run.mixed.num_right},
                     {"num_wrong", run.mixed.num_wrong},
                     {"num_right_lost", run.mixed.num_right_lost},
                     {"num_wrong_kept", run.mixed.num_wrong_kept},
                     {"ate", run.mixed_ate}};
  if (run.method.ends_with("+refine")) json["refinement"] = ToJson(run.refinement);
  return json;
}

}  // namespace parkade

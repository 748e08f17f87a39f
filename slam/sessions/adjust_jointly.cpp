#include "slam/sessions/adjust_jointly.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/log.h"
#include "core/math/decompositions.h"
#include "core/math/statistics.h"
#include "slam/sessions/random_walk_modes.h"
#include "slam/sessions/session_loop_cost.h"

namespace parkade {
namespace {

constexpr double kRobustWidth = 2;     // [sigma] Cauchy, of links
constexpr Eigen::Index kNumMount = 6;  // modes that move what a drive sees, but not the drive
constexpr int kMaxSteps = 20;

/// A drive as unknowns.
struct BentDrive {
  std::array<double, kFrameSize> frame{};
  std::vector<double> bends;             ///< amounts of its modes, then of its mounts
  std::vector<PerturbedPose> keyframes;  ///< moved by frame and bends
  bool is_settled = false;               ///< its frame stays

  int num_bends() const { return static_cast<int>(bends.size()); }

  std::vector<Rigid3> WithoutMounts() const {
    std::vector<double> own = bends;
    std::fill(own.end() - kNumMount, own.end(), 0);
    std::vector<Rigid3> group_from_keyframe;
    for (const PerturbedPose& keyframe : keyframes)
      group_from_keyframe.push_back(keyframe.InSite(frame.data(), own.data()));
    return group_from_keyframe;
  }
};

/// The rotation about z and the translation that carry keyframes from odom nearest to where the
/// group has them.
std::array<double, kFrameSize> FrameOf(const std::vector<RigKeyframe>& keyframes,
                                       const std::vector<Rigid3>& group_from_keyframe) {
  Eigen::Vector3d forward = Eigen::Vector3d::Zero(), in_odom = forward, in_group = forward;
  for (size_t i = 0; i < keyframes.size(); ++i) {
    const Rigid3& odom_from_keyframe = keyframes[i].odom_from_keyframe;
    forward += group_from_keyframe[i].rotation * odom_from_keyframe.rotation.conjugate() *
               Eigen::Vector3d::UnitX();
    in_odom += odom_from_keyframe.translation;
    in_group += group_from_keyframe[i].translation;
  }
  const double yaw = std::atan2(forward.y(), forward.x());
  const Eigen::Vector3d shift =
      (in_group - ExpSo3({0, 0, yaw}) * in_odom) / static_cast<double>(keyframes.size());
  return {yaw, shift.x(), shift.y(), shift.z()};
}

/// A pose with some modes, which are left zero, and those of its drive's mounts.
PerturbedPose WithMounts(const Rigid3& pose, Eigen::Index num_modes, const LoopOptions& loops) {
  const Eigen::Matrix3d turn = pose.rotation.toRotationMatrix();
  const double rotation = loops.relative_pose.mount_rotation_deg * M_PI / 180;
  PerturbedPose perturbed{pose, Eigen::MatrixXd::Zero(6, num_modes + kNumMount)};
  perturbed.modes.topRightCorner(3, kNumMount).leftCols<3>() = rotation * turn;
  perturbed.modes.bottomRightCorner<3, 3>() = loops.relative_pose.mount_translation * turn;
  return perturbed;
}

BentDrive MakeBent(const DriveToJoin& drive, const LoopOptions& loops,
                   const std::vector<Rigid3>& group_from_keyframe) {
  const CovarianceModes modes = drive.modes.empty() ? RandomWalkModes(drive, loops) : drive.modes;
  BentDrive bent;
  bent.frame = FrameOf(drive.keyframes, group_from_keyframe);
  bent.bends.resize(static_cast<size_t>(modes.size() + kNumMount));
  for (const RigKeyframe& keyframe : drive.keyframes) {
    PerturbedPose& pose =
        bent.keyframes.emplace_back(WithMounts(keyframe.odom_from_keyframe, modes.size(), loops));
    pose.modes.leftCols(modes.size()) = modes.At(keyframe.time);
  }
  return bent;
}

/// A drive that stays where it is, but for its mounts.
BentDrive MakeSettled(const std::vector<Rigid3>& site_from_keyframe, const LoopOptions& loops) {
  BentDrive settled;
  settled.is_settled = true;
  settled.bends.resize(kNumMount);
  for (const Rigid3& pose : site_from_keyframe)
    settled.keyframes.push_back(WithMounts(pose, 0, loops));
  return settled;
}

/// Median squared error of the links that count [sigma^2].
std::vector<double> SquaredErrorsOf(const std::vector<DrivePair*>& pairs) {
  std::vector<double> errors;
  for (const DrivePair* pair : pairs)
    for (size_t i = 0; i < pair->weights.size(); ++i)
      if (pair->weights[i] > 0.5) errors.push_back(pair->chi_squared[i]);
  return errors;
}

/// A link in the problem, and where its error goes.
struct PosedLink {
  const ceres::CostFunction* cost = nullptr;
  std::vector<const double*> parameters;
  double share = 1;
  double* chi_squared = nullptr;
};

class JointProblem {
 public:
  JointProblem(const std::vector<DriveToJoin>& drives, const LoopOptions& loops)
      : drives_(drives), loops_(loops) {}

  void AddDrive(BentDrive& drive, bool has_fixed_frame) {
    problem_.AddParameterBlock(drive.frame.data(), kFrameSize);
    if (has_fixed_frame) problem_.SetParameterBlockConstant(drive.frame.data());
    const int size = drive.num_bends();
    problem_.AddResidualBlock(
        new ceres::NormalPrior(ceres::Matrix::Identity(size, size), ceres::Vector::Zero(size)),
        nullptr, drive.bends.data());
  }

  void AddLinks(DrivePair& pair, BentDrive& a, BentDrive& b) {
    const std::vector<SessionLoop>& links = pair.found.links;
    const std::vector<double> shares =
        SharesOf(links, drives_[pair.drive_a].keyframes, drives_[pair.drive_b].keyframes,
                 loops_.shared_reach);
    for (size_t i = 0; i < links.size(); ++i) {
      if (pair.weights[i] <= 0.5) continue;
      const RelativePose& measured = links[i].pose;
      auto* const cost =
          new SessionLoopCost(a.keyframes[links[i].keyframe_a], b.keyframes[links[i].keyframe_b],
                              measured.a_from_b, SquareRootOf(shares[i] * measured.information));
      problem_.AddResidualBlock(cost, new ceres::CauchyLoss(kRobustWidth), a.frame.data(),
                                a.bends.data(), b.frame.data(), b.bends.data());
      links_.push_back({cost,
                        {a.frame.data(), a.bends.data(), b.frame.data(), b.bends.data()},
                        shares[i],
                        &pair.chi_squared[i]});
    }
  }

  size_t num_links() const { return links_.size(); }

  /// Returns whether there is a solution.
  bool Solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    options.max_num_iterations = kMaxSteps;
    options.initial_trust_region_radius = 1e8;
    options.num_threads = 1;  // sums keep their order
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable() || !std::isfinite(summary.final_cost)) return false;
    for (const PosedLink& link : links_) {
      Vector6d error;
      link.cost->Evaluate(link.parameters.data(), error.data(), nullptr);
      *link.chi_squared = error.squaredNorm() / link.share;
    }
    return true;
  }

 private:
  const std::vector<DriveToJoin>& drives_;
  const LoopOptions& loops_;
  ceres::Problem problem_;
  std::vector<PosedLink> links_;
};

}  // namespace

JointAdjustment AdjustJointly(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
                              const SettledDrives& settled, const std::vector<DrivePair*>& pairs,
                              std::vector<std::vector<Rigid3>>& group_from_keyframe) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::optional<BentDrive>> bent(drives.size());
  JointProblem problem(drives, loops);
  bool has_fixed = false;
  for (size_t i = 0; i < drives.size(); ++i)
    has_fixed = has_fixed || (settled.Holds(i) && !group_from_keyframe[i].empty());
  for (size_t i = 0; i < drives.size(); ++i) {
    if (group_from_keyframe[i].empty()) continue;
    bent[i] = settled.Holds(i) ? MakeSettled(settled.PosesOf(i), loops)
                               : MakeBent(drives[i], loops, group_from_keyframe[i]);
    problem.AddDrive(*bent[i], settled.Holds(i) || !has_fixed);
    has_fixed = true;
  }
  for (DrivePair* pair : pairs) problem.AddLinks(*pair, *bent[pair->drive_a], *bent[pair->drive_b]);
  JointAdjustment result;
  result.num_links = static_cast<int>(problem.num_links());
  result.before = result.after = Median(SquaredErrorsOf(pairs));
  if (problem.Solve()) {
    result.after = Median(SquaredErrorsOf(pairs));
    for (size_t i = 0; i < drives.size(); ++i) {
      if (!bent[i] || bent[i]->is_settled) continue;
      const std::vector<Rigid3> moved = bent[i]->WithoutMounts();
      for (size_t k = 0; k < moved.size(); ++k)
        result.largest_correction =
            std::max(result.largest_correction,
                     (moved[k].translation - group_from_keyframe[i][k].translation).norm());
      group_from_keyframe[i] = moved;
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  LogInfo("stage=joint_adjustment links=" + std::to_string(result.num_links) +
          " seconds=" + std::to_string(result.seconds));
  return result;
}

}  // namespace parkade

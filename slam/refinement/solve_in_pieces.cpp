#include "slam/refinement/solve_in_pieces.h"

#include <algorithm>
#include <set>

#include "slam/pose_graph/optimize_pose_graph.h"

namespace parkade {
namespace {

constexpr size_t kSeparatorEvery = 20;  // [nodes]
// Random walk of the refined drive between separators, which bends where loops pull.
constexpr double kWalkTranslation = 0.001;  // [m / sqrt(m)]
constexpr double kWalkRotation = 0.0002;    // [rad / sqrt(m)]
constexpr double kTiltSigma = 0.0005;       // [rad]
constexpr double kLeastWay = 0.1;           // [m]

/// Without roll and pitch, which each node knows from gravity.
Rigid3 YawAndPlace(const Rigid3& odom_from_odom, const Eigen::Vector3d& around) {
  const Eigen::Vector3d forward = odom_from_odom.rotation * Eigen::Vector3d::UnitX();
  const Eigen::Quaterniond turn = ExpSo3({0, 0, std::atan2(forward.y(), forward.x())});
  return {turn, odom_from_odom * around - turn * around};
}

/// The calibration that the pieces find, summed up.
class MeanCalibration {
 public:
  void Add(const std::vector<CameraParameters>& cameras, double wheel_scale) {
    if (first_.empty()) {
      first_ = cameras;
      changes_.resize(cameras.size(), Change::Zero());
    }
    for (size_t i = 0; i < cameras.size(); ++i) {
      const Rigid3 change = first_[i].ImuFromCamera().Inverse() * cameras[i].ImuFromCamera();
      changes_[i].head<3>() += LogSo3(change.rotation);
      changes_[i].segment<3>(3) += change.translation;
      for (int k = 0; k < kTimingSize; ++k)
        changes_[i][6 + k] +=
            cameras[i].timing[static_cast<size_t>(k)] - first_[i].timing[static_cast<size_t>(k)];
    }
    wheel_scale_ += wheel_scale;
    ++count_;
  }

  void Set(DriveAdjustment& adjustment) const {
    std::vector<CameraParameters> cameras = first_;
    for (size_t i = 0; i < cameras.size(); ++i) {
      const Change mean = changes_[i] / count_;
      PoseToParameters(
          first_[i].ImuFromCamera() * Rigid3{ExpSo3(mean.head<3>()), mean.segment<3>(3)},
          cameras[i].extrinsics.data());
      for (int k = 0; k < kTimingSize; ++k)
        cameras[i].timing[static_cast<size_t>(k)] += mean[6 + k];
    }
    adjustment.SetCalibration(cameras, wheel_scale_ / count_);
  }

 private:
  using Change = Eigen::Matrix<double, 6 + kTimingSize, 1>;
  std::vector<CameraParameters> first_;
  std::vector<Change> changes_;
  double wheel_scale_ = 0, count_ = 0;
};

/// Solves the piece with its end open, and moves what follows as its last node moved.
int SolveAndCarry(DriveAdjustment& adjustment, size_t begin, size_t end,
                  const SolveLimits& limits) {
  const Rigid3 before = adjustment.States()[end - 1].odom_from_imu;
  const bool is_last = end == adjustment.num_nodes();
  const int num_steps = adjustment.Solve({begin, end, !is_last, true}, limits);
  if (is_last) return num_steps;
  const Rigid3 after = adjustment.States()[end - 1].odom_from_imu;
  std::vector<Rigid3> moves(adjustment.num_nodes());
  std::fill(moves.begin() + static_cast<std::ptrdiff_t>(end), moves.end(),
            YawAndPlace(after * before.Inverse(), before.translation));
  adjustment.MoveNodes(moves);
  return num_steps;
}

/// The separators' graph: odometry between them, gravity, and the loops.
PoseGraph GraphOf(const std::vector<MotionState>& states, const std::vector<size_t>& separators,
                  const std::vector<AdjustedLoop>& loops) {
  PoseGraph graph;
  graph.vertices.push_back({-1'000'000, {}, true});  // the world
  const auto vertex_of = [&](size_t node) {
    return 1 + static_cast<size_t>(std::lower_bound(separators.begin(), separators.end(), node) -
                                   separators.begin());
  };
  for (size_t i = 0; i < separators.size(); ++i) {
    const Rigid3& pose = states[separators[i]].odom_from_imu;
    graph.vertices.push_back({static_cast<std::int64_t>(i), pose, i == 0});
    // Gravity leaves turns about odom's vertical free.
    const Eigen::Vector3d up = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    PoseGraphEdge gravity{0, i + 1, pose, Matrix6d::Zero(), true};
    gravity.information.bottomRightCorner<3, 3>() =
        (Eigen::Matrix3d::Identity() - up * up.transpose()) / (kTiltSigma * kTiltSigma);
    graph.edges.push_back(gravity);
    if (i == 0) continue;
    const Rigid3& previous = states[separators[i - 1]].odom_from_imu;
    const double way = std::max((pose.translation - previous.translation).norm(), kLeastWay);
    Vector6d variances;
    variances << Eigen::Vector3d::Constant(kWalkTranslation * kWalkTranslation * way),
        Eigen::Vector3d::Constant(kWalkRotation * kWalkRotation * way);
    graph.edges.push_back(
        {i, i + 1, previous.Inverse() * pose, variances.cwiseInverse().asDiagonal(), true});
  }
  for (const AdjustedLoop& loop : loops)
    if (loop.is_used)
      graph.edges.push_back({vertex_of(loop.from), vertex_of(loop.to), loop.from_from_to,
                             loop.square_root_weight.transpose() * loop.square_root_weight, false});
  return graph;
}

/// Closes the loops between separators and carries the nodes between them along.
void CloseBetweenPieces(DriveAdjustment& adjustment) {
  const std::vector<MotionState> states = adjustment.States();
  std::set<size_t> chosen = {0, states.size() - 1};
  for (size_t i = 0; i < states.size(); i += kSeparatorEvery) chosen.insert(i);
  for (const AdjustedLoop& loop : adjustment.loops())
    if (loop.is_used) chosen.insert({loop.from, loop.to});
  const std::vector<size_t> separators(chosen.begin(), chosen.end());
  PoseGraph graph = GraphOf(states, separators, adjustment.loops());
  PoseGraphOptions options;
  options.objective = "information";
  options.start = "given";
  OptimizePoseGraph(options, graph);
  std::vector<Rigid3> moves(states.size());
  for (size_t i = 0; i + 1 < separators.size(); ++i) {
    const auto move_of = [&](size_t separator) {
      const Rigid3& before = states[separators[separator]].odom_from_imu;
      return graph.vertices[separator + 1].world_from_vertex * before.Inverse();
    };
    const double count = static_cast<double>(separators[i + 1] - separators[i]);
    for (size_t node = separators[i]; node <= separators[i + 1]; ++node) {
      const Rigid3& pose = states[node].odom_from_imu;
      const double fraction = static_cast<double>(node - separators[i]) / count;
      moves[node] =
          Interpolate(move_of(i) * pose, move_of(i + 1) * pose, fraction) * pose.Inverse();
    }
  }
  adjustment.MoveNodes(moves);
}

}  // namespace

int NumPieces(size_t num_nodes, const PieceOptions& options) {
  if (num_nodes <= options.max_nodes) return 1;
  return static_cast<int>((num_nodes + options.piece_nodes - 1) / options.piece_nodes);
}

int SolveInPieces(DriveAdjustment& adjustment, const PieceOptions& options) {
  const size_t count = adjustment.num_nodes(), piece = options.piece_nodes;
  if (NumPieces(count, options) == 1)
    return adjustment.Solve({0, count, false, true}, options.limits);
  int num_steps = 0;
  MeanCalibration calibration;
  for (size_t begin = 0, end = 0; end < count; begin += piece - piece / 4) {
    end = std::min(begin + piece, count);
    num_steps += SolveAndCarry(adjustment, begin, end, options.limits);
    calibration.Add(adjustment.Cameras(), adjustment.WheelScale());
  }
  calibration.Set(adjustment);
  const auto& loops = adjustment.loops();
  if (std::any_of(loops.begin(), loops.end(),
                  [](const AdjustedLoop& loop) { return loop.is_used; }))
    CloseBetweenPieces(adjustment);
  const SolveLimits at_seams{options.limits.max_steps / 2, options.limits.least_fall};
  for (const size_t shift : {size_t{0}, piece / 2})
    for (size_t begin = 0; begin < count + shift; begin += piece) {
      const size_t from = begin - std::min(begin, shift),
                   to = std::min(begin + piece - shift, count);
      if (from < to) num_steps += adjustment.Solve({from, to, false, false}, at_seams);
    }
  return num_steps;
}

}  // namespace parkade

#include "slam/smoother/mount_jumps.h"

#include <algorithm>
#include <map>

#include "core/math/decompositions.h"
#include "slam/factors/fit_rotation.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

constexpr double kMinTurn = 0.5 * M_PI / 180;  // [rad] that is no error of the motion
constexpr double kMaxErrorLeft = 0.3;  // share of the error that the turn may leave unexplained
constexpr double kOthersShare =
    0.3;  // of that turn, by which other cameras may seem to turn at most
constexpr double kMinSpread =
    0.15;  // of the pairs: a car behind fills many tracks, but not the view
constexpr double kTurnSigma = 0.01;  // [rad] of the new rotation, plus a share of the turn
constexpr double kTurnShare = 0.2;
constexpr double kShiftSigma = 0.02;  // [m] by which the camera may have moved

/// The turns by which the new views' landmarks are off, in the order of the views.
std::vector<std::pair<const WindowView*, Turn>> FitTurns(size_t first_new_view,
                                                         const SmootherWindow& window) {
  std::map<const WindowView*, std::vector<DirectionPair>> seen_in;
  for (const auto& [number, track] : window.tracks) {
    if (!track.has_landmark) continue;
    for (auto seen = track.observations.rbegin(); seen != track.observations.rend(); ++seen) {
      const auto is_new =
          std::any_of(window.views.begin() + static_cast<long>(first_new_view), window.views.end(),
                      [&](const WindowView& view) { return &view == seen->view; });
      if (!is_new) break;
      const Eigen::Vector3d direction = LandmarkInCamera(seen->view->geometry, track.ray,
                                                         track.landmark.data(), seen->bearing.row);
      seen_in[seen->view].push_back({direction.normalized(), seen->bearing.direction});
    }
  }
  std::vector<std::pair<const WindowView*, Turn>> turns;
  for (size_t i = first_new_view; i < window.views.size(); ++i)
    if (const auto found = seen_in.find(&window.views[i]); found != seen_in.end())
      if (const std::optional<Turn> turn = FitRotation(found->second))
        turns.emplace_back(&window.views[i], *turn);
  return turns;
}

void RotateMount(const Eigen::Quaterniond& new_from_old, double* extrinsics) {
  const Rigid3 pose = PoseFromParameters(extrinsics);
  PoseToParameters({(pose.rotation * new_from_old.conjugate()).normalized(), pose.translation},
                   extrinsics);
}

/// The old extrinsics c leave the prior, the new ones c' enter it: c' = c, turned, + noise.
/// Returns what the old ones were, given the rest.
StateConditional ReopenExtrinsics(int camera, const Eigen::Quaterniond& new_from_old,
                                  const CameraSigmas& sigmas, LinearPrior& prior) {
  constexpr Eigen::Index kOwn = kPoseTangentSize;
  const StateName name{Kind::kExtrinsics, camera};
  const Eigen::Index width = prior.sqrt_information.cols(), height = prior.sqrt_information.rows();
  const Eigen::Index column = prior.ColumnOf(name);
  Eigen::Vector<double, 6> weight;
  weight << Eigen::Vector3d::Constant(1 / sigmas.rotation),
      Eigen::Vector3d::Constant(1 / sigmas.translation);
  Eigen::Matrix<double, 6, 6> carry = Eigen::Matrix<double, 6, 6>::Identity();
  carry.topLeftCorner<3, 3>() = new_from_old.toRotationMatrix();

  // Columns: c | all states, c' in the place of c | offset.
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(height + kOwn, kOwn + width + 1);
  rows.block(0, 0, height, kOwn) = prior.sqrt_information.middleCols(column, kOwn);
  rows.block(0, kOwn, height, width) = prior.sqrt_information;
  rows.block(0, kOwn + column, height, kOwn).setZero();
  rows.block(0, kOwn + width, height, 1) = prior.offset;
  rows.block<kOwn, kOwn>(height, 0) = -(weight.asDiagonal() * carry);
  rows.block<kOwn, kOwn>(height, kOwn + column) = weight.asDiagonal();
  const Eigen::MatrixXd root = TriangularFactor(rows);

  std::vector<Eigen::Index> place;  // of the old states among the columns
  for (Eigen::Index k = 0; k < width; ++k)
    place.push_back(k >= column && k < column + kOwn ? k - column : kOwn + k);
  const Eigen::MatrixXd link = rows.block(height, 0, kOwn, kOwn + width);
  Eigen::MatrixXd score_covariance = link.transpose() * link;
  score_covariance(place, place) += prior.score_covariance;
  Eigen::MatrixXd score_sensitivity =
      Eigen::MatrixXd::Zero(kOwn + width, prior.score_sensitivity.cols());
  score_sensitivity(place, Eigen::all) = prior.score_sensitivity;
  ScoreElimination scores =
      EliminateScores(score_covariance, score_sensitivity, root.topLeftCorner(kOwn, kOwn),
                      root.block(0, kOwn, kOwn, width));

  StateConditional old{{},
                       root.topLeftCorner(kOwn, kOwn).cast<float>(),
                       root.block(0, kOwn, kOwn, width).cast<float>(),
                       root.block(0, kOwn + width, kOwn, 1).cast<float>(),
                       scores.dropped.cast<float>(),
                       scores.cross.cast<float>(),
                       scores.dropped_sensitivity.cast<float>(),
                       prior.blocks};
  for (PriorBlock& block : old.rest) {
    if (block.name != name) continue;
    old.states.push_back(block);  // as it was
    RotateMount(new_from_old, block.at.data());
  }
  const Eigen::Index kept = std::min(width, root.rows() - kOwn);
  prior.sqrt_information = root.block(kOwn, kOwn, kept, width);
  prior.offset = root.block(kOwn, kOwn + width, kept, 1);
  prior.score_covariance = std::move(scores.kept);
  prior.score_sensitivity = std::move(scores.kept_sensitivity);
  return old;
}

/// The camera of `first_view` sits otherwise from there on. Returns what its extrinsics were
/// before, where they are estimated.
std::optional<StateConditional> RotateCamera(const WindowView& first_view,
                                             const Eigen::Quaterniond& new_from_old,
                                             SmootherWindow& window) {
  const int camera = first_view.camera;
  for (auto& [number, track] : window.tracks) {
    std::erase_if(track.observations, [&](const TrackObservation& seen) {
      return seen.view->camera == camera && seen.view->time < first_view.time;
    });
    if (track.observations.size() < 2) track.has_landmark = false;
  }
  std::optional<StateConditional> old;
  if (window.IsEstimated({Kind::kExtrinsics, camera})) {
    const double angle = new_from_old.angularDistance(Eigen::Quaterniond::Identity());
    old = ReopenExtrinsics(camera, new_from_old,
                           {kTurnSigma + kTurnShare * angle, kShiftSigma, 0, 0}, window.prior);
    for (PriorBlock& block : window.prior.blocks)
      if (block.name == StateName{Kind::kExtrinsics, camera})
        RotateMount(new_from_old, block.at.data());
  }
  RotateMount(new_from_old, window.cameras[static_cast<size_t>(camera)].extrinsics.data());
  window.PointViewsAtNodes();
  return old;
}

}  // namespace

std::vector<MountJump> FindMountJumps(size_t first_new_view, SmootherWindow& window) {
  std::vector<MountJump> jumps;
  const std::vector<std::pair<const WindowView*, Turn>> turns = FitTurns(first_new_view, window);
  for (const auto& [view, turn] : turns) {
    if (turn.angle < kMinTurn || turn.error_after > kMaxErrorLeft * turn.error_before ||
        turn.spread < kMinSpread)
      continue;
    const bool is_alone =
        turns.size() > 1 && std::all_of(turns.begin(), turns.end(), [&](const auto& other) {
          return other.first->camera == view->camera ||
                 other.second.angle < kOthersShare * turn.angle;
        });
    if (!is_alone) continue;
    jumps.push_back({{view->time, view->camera, turn.angle},
                     RotateCamera(*view, turn.measured_from_predicted, window)});
  }
  return jumps;
}

}  // namespace parkade

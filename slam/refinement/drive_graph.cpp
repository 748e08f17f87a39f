#include "slam/refinement/drive_graph.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr int kMinObservations = 2;  // of a landmark within a stretch

}  // namespace

DriveGraph::DriveGraph(AdjustedDrive& drive, const AdjustedStretch& stretch, double bearing_weight)
    : drive_(drive), stretch_(stretch), graph_(drive.arena, bearing_weight) {
  drive_.PointImages();
  AddIntervals();
  AddCalibration();
  AddLoops();
  AddFixes();
  AddLandmarks();
}

double* DriveGraph::PoseOf(size_t node) {
  graph_.AddPose(drive_.nodes[node].pose, IsMoved(node));
  return drive_.nodes[node].pose;
}

const NodeBlocks& DriveGraph::NodeOf(size_t node) {
  PoseOf(node);
  graph_.AddMotion(drive_.nodes[node].motion, IsMoved(node));
  return drive_.nodes[node];
}

double* DriveGraph::BlockOf(const StateName& name) const {
  const auto number = static_cast<size_t>(name.number);
  switch (name.kind) {
    case StateName::Kind::kPose: return drive_.nodes[number].pose;
    case StateName::Kind::kMotion: return drive_.nodes[number].motion;
    case StateName::Kind::kExtrinsics: return drive_.cameras[number].extrinsics;
    case StateName::Kind::kTiming: return drive_.cameras[number].timing;
    case StateName::Kind::kWheelScale: break;
  }
  return drive_.wheel_scale;
}

// In the order of the drive, so that the factorization sees a band.
void DriveGraph::AddIntervals() {
  const size_t last =
      stretch_.has_open_end
          ? stretch_.end
          : std::min(stretch_.end + 1, drive_.nodes.size());  // behind those that matter
  for (size_t k = stretch_.begin; k < last; ++k) {
    const NodeBlocks& j = NodeOf(k);
    if (k == 0 || !drive_.nodes[k].interval) continue;
    const NodeBlocks& i = NodeOf(k - 1);
    const NodeInterval& interval = *drive_.nodes[k].interval;
    graph_.AddImu(interval.imu, i, j);
    if (interval.is_still) graph_.AddStandstill(i, j);
    if (!interval.wheels) continue;
    graph_.AddWheelScale(drive_.wheel_scale, stretch_.frees_calibration);
    graph_.AddWheels(*interval.wheels, i, j, drive_.wheel_scale);
  }
}

void DriveGraph::AddCalibration() {
  for (size_t i = 0; i < drive_.cameras.size(); ++i) {
    const CameraSigmas& prior = drive_.camera_priors[i];
    graph_.AddCamera(drive_.cameras[i], stretch_.frees_calibration && prior.rotation > 0,
                     stretch_.frees_calibration && (prior.time_offset > 0 || prior.line_delay > 0));
  }
  for (const LinearPrior& prior : drive_.priors) {
    double* block = BlockOf(prior.blocks.front().name);
    if (graph_.Contains(block)) graph_.AddPrior(prior, {block});
  }
}

void DriveGraph::AddLoops() {
  for (const AdjustedLoop& loop : drive_.loops) {
    if (!loop.is_used || !(IsMoved(loop.from) || IsMoved(loop.to)) ||
        IsLeftOut(std::max(loop.from, loop.to)))
      continue;
    double* from = PoseOf(loop.from);
    double* to = PoseOf(loop.to);
    graph_.AddLoop(loop.from_from_to, loop.square_root_weight, from, to);
  }
}

void DriveGraph::AddFixes() {
  for (const AdjustedFix& fix : drive_.fixes) {
    if ((!IsMoved(fix.first) && !IsMoved(fix.first + 1)) || IsLeftOut(fix.first + 1)) continue;
    graph_.AddSiteFromOdom(drive_.site_from_odom, stretch_.frees_calibration);
    double* i = PoseOf(fix.first);
    double* j = PoseOf(fix.first + 1);
    graph_.AddFix(fix.antenna, i, j, drive_.site_from_odom);
  }
}

void DriveGraph::AddLandmarks() {
  const auto is_moved = [&](const AdjustedObservation& seen) {
    const AdjustedImage& image = drive_.images[seen.image];
    return IsMoved(image.first) || IsMoved(image.second);
  };
  const auto is_seen_here = [&](const AdjustedObservation& seen) {
    return !IsLeftOut(drive_.images[seen.image].second);
  };
  for (const AdjustedLandmark& landmark : drive_.landmarks) {
    const auto& observations = landmark.observations;
    if (!landmark.is_used || std::none_of(observations.begin(), observations.end(), is_moved) ||
        std::count_if(observations.begin(), observations.end(), is_seen_here) < kMinObservations)
      continue;
    graph_.AddLandmark(landmark.values);
    for (const AdjustedObservation& seen : observations) {
      if (!is_seen_here(seen)) continue;
      AdjustedImage& image = drive_.images[seen.image];
      PoseOf(image.first);
      PoseOf(image.second);
      graph_.AddBearing(*seen.cost, image.geometry, landmark.values);
    }
  }
}

}  // namespace parkade

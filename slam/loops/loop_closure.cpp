// The list of loops of report.json.
#include "slam/loops/loop_closure.h"

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace parkade {
namespace {

std::string StateOf(const LoopEvidence& loop) {
  if (!loop.pose.rejected.empty()) return loop.pose.rejected;
  if (loop.is_forced) return "forced by the reviewer";
  return loop.weight > 0.5 ? "accepted" : "rejected by the pose graph";
}

nlohmann::json ToJson(const LoopEvidence& loop) {
  const RelativePose& pose = loop.pose;
  const Eigen::Vector3d &t = pose.a_from_b.translation, turn = LogSo3(pose.a_from_b.rotation);
  nlohmann::json pairs = nlohmann::json::array();
  for (const CameraPairInliers& pair : pose.inliers_of_cameras)
    pairs.push_back(
        {{"earlier", pair.camera_a}, {"later", pair.camera_b}, {"num_inliers", pair.count}});
  nlohmann::json information = nlohmann::json::array();  // upper triangle, row by row
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      information.push_back(pose.information(row, column));
  return {{"id", loop.id},
          {"earlier", static_cast<double>(loop.earlier.ns) * 1e-9},
          {"later", static_cast<double>(loop.later.ns) * 1e-9},
          {"way", loop.way},
          {"score", loop.score},
          {"num_matches", pose.num_matches},
          {"num_first_inliers", pose.num_first_inliers},
          {"num_inliers", pose.num_inliers},
          {"num_camera_pairs", pose.num_camera_pairs},
          {"camera_pairs", pairs},
          {"inliers", ToJson(pose.shown)},
          {"residual", pose.residual},
          {"worst_sigma", pose.worst_sigma},
          {"information", information},
          {"information_share", loop.share},
          {"translation", {t.x(), t.y(), t.z()}},
          {"rotation_vector", {turn.x(), turn.y(), turn.z()}},
          {"odometry_disagreement", loop.odometry_disagreement},
          {"chi_squared", loop.chi_squared},
          {"weight", loop.weight},
          {"state", StateOf(loop)}};
}

}  // namespace

void LoopOptions::Validate() const {
  Require(
      method == "rig" || method == "scale-less" || method == "rotation-only" || method == "pnp" ||
          method == "none",
      ErrorCode::kUsage,
      "loops are closed by rig, scale-less, rotation-only, pnp or none, not by '" + method + "'");
  keyframes.Validate();
  recognition.Validate();
  relative_pose.Validate();
  Require(odometry_translation > 0 && odometry_yaw > 0 && odometry_tilt > 0 && shared_reach > 0,
          ErrorCode::kUsage, "the sigmas of odometry and the reach of loops must be positive");
}

nlohmann::json ToJson(const LoopClosure& closure) {
  nlohmann::json json = {
      {"num_places", closure.num_keyframes},  {"num_candidates", closure.loops.size()},
      {"num_accepted", closure.num_accepted}, {"largest_correction", closure.largest_correction},
      {"seconds", closure.seconds},           {"candidates", nlohmann::json::array()}};
  for (const LoopEvidence& loop : closure.loops) json["candidates"].push_back(ToJson(loop));
  return json;
}

}  // namespace parkade

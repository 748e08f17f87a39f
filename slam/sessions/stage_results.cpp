#include "slam/sessions/stage_results.h"

#include <utility>

#include "core/binary_serialization.h"

namespace parkade {

// Found by argument-dependent lookup, hence in the types' own namespace.
template <typename A>
void Serialize(A& archive, CameraPairInliers& inliers) {
  archive(inliers.camera_a, inliers.camera_b, inliers.count);
}
template <typename A>
void Serialize(A& archive, MatchedPoint& point) {
  archive(point.a, point.b);
}
template <typename A>
void Serialize(A& archive, ShownInliers& shown) {
  archive(shown.camera_a, shown.camera_b, shown.image_a, shown.image_b, shown.points);
}
template <typename A>
void Serialize(A& archive, RelativePose& pose) {
  archive(pose.a_from_b, pose.information, pose.num_matches, pose.num_inliers,
          pose.num_camera_pairs, pose.num_first_inliers, pose.inliers_of_cameras, pose.shown,
          pose.residual, pose.worst_sigma, pose.rejected);
}
template <typename A>
void Serialize(A& archive, CameraLead& lead) {
  archive(lead.camera, lead.ahead, lead.sigma);
}
template <typename A>
void Serialize(A& archive, SensorAgreement& agreement) {
  archive(agreement.turn_gain, agreement.turn_gain_sigma, agreement.turn_delay,
          agreement.turn_delay_sigma, agreement.leads, agreement.body_lead,
          agreement.body_lead_sigma, agreement.num_pairs);
}
template <typename A>
void Serialize(A& archive, ImageResidual& image) {
  archive(image.time, image.camera, image.num_inliers, image.rms);
}
template <typename A>
void Serialize(A& archive, WheelSlip& slip) {
  archive(slip.time, slip.speed);
}
template <typename A>
void Serialize(A& archive, DriveResiduals& residuals) {
  archive(residuals.images, residuals.wheels);
}
template <typename A>
void Serialize(A& archive, LoopEvidence& loop) {
  cv::Mat no_view;  // older files have one of either end here
  archive(loop.id, loop.earlier_keyframe, loop.later_keyframe, loop.earlier_camera,
          loop.later_camera, no_view, no_view, loop.earlier, loop.later, loop.way, loop.score,
          loop.pose, loop.earlier_from_camera, loop.later_from_camera, loop.is_forced, loop.share,
          loop.chi_squared, loop.weight, loop.odometry_disagreement);
}
template <typename A>
void Serialize(A& archive, LoopClosure& closure) {
  archive(closure.odom_from_body, closure.loops, closure.num_keyframes, closure.num_accepted,
          closure.largest_correction);
}
template <typename A>
void Serialize(A& archive, AdjustmentStatistics& statistics) {
  archive(statistics.imu, statistics.wheels, statistics.bearings, statistics.loops,
          statistics.unused_loops, statistics.gnss, statistics.unused_bearings,
          statistics.num_bearings, statistics.num_landmarks);
}
template <typename A>
void Serialize(A& archive, CameraRefinement& camera) {
  archive(camera.name, camera.rotation, camera.translation, camera.time_offset, camera.is_taken);
}
template <typename A>
void Serialize(A& archive, CovarianceModes& modes) {
  archive(modes.times, modes.modes);
}
template <typename A>
void Serialize(A& archive, DriveRefinement& refinement) {
  archive(refinement.odom_from_body, refinement.is_accepted, refinement.reason, refinement.before,
          refinement.after, refinement.cameras, refinement.wheel_scale, refinement.num_nodes,
          refinement.num_fixes, refinement.num_loops, refinement.num_held_out,
          refinement.num_pieces, refinement.num_iterations, refinement.largest_correction,
          refinement.modes);
  std::uint64_t num_cameras = refinement.rig.cameras.size();
  archive(num_cameras);
  Require(num_cameras == refinement.rig.cameras.size(), ErrorCode::kInvalidInput,
          "it is of another rig");
  for (RigCamera& camera : refinement.rig.cameras)
    archive(camera.body_from_camera, camera.time_shift, camera.line_delay);
}
template <typename A>
void Serialize(A& archive, SessionLoop& link) {
  archive(link.keyframe_a, link.keyframe_b, link.score, link.pose);
}
template <typename A>
void Serialize(A& archive, BevAgreement& agreement) {
  archive(agreement.num_tiles, agreement.num_best);
}
template <typename A>
void Serialize(A& archive, BevEvidence& floor) {
  archive(floor.within, floor.across);
}
template <typename A>
void Serialize(A& archive, SessionLoops& links) {
  archive(links.links, links.num_candidates, links.num_measured, links.num_agreeing,
          links.num_rivals, links.rejected, links.floor);
}

namespace {

template <typename Result>
std::string Encode(Result& result) {
  BinaryWriter writer;
  writer(result);
  return std::move(writer).Take();
}

template <typename Result>
Result Decode(std::string_view bytes, Result result = {}) {
  BinaryReader reader(bytes);
  reader(result);
  Require(reader.is_at_end(), ErrorCode::kInvalidInput, "it is longer than it says");
  return result;
}

}  // namespace

std::string EncodeAgreement(SensorAgreement agreement) { return Encode(agreement); }
SensorAgreement DecodeAgreement(std::string_view bytes) { return Decode<SensorAgreement>(bytes); }

std::string EncodeLoops(LoopClosure loops) {
  BinaryWriter writer;
  writer(loops, loops.views);
  return std::move(writer).Take();
}

LoopClosure DecodeLoops(std::string_view bytes) {
  BinaryReader reader(bytes);
  LoopClosure loops;
  reader(loops);
  if (!reader.is_at_end()) reader(loops.views);
  Require(reader.is_at_end(), ErrorCode::kInvalidInput, "it is longer than it says");
  return loops;
}

std::string EncodeRefinement(DriveRefinement refinement) { return Encode(refinement); }
DriveRefinement DecodeRefinement(std::string_view bytes, const Rig& rig) {
  DriveRefinement refinement;
  refinement.rig = rig;
  return Decode(bytes, std::move(refinement));
}

std::string EncodeResiduals(DriveResiduals residuals) { return Encode(residuals); }
DriveResiduals DecodeResiduals(std::string_view bytes) { return Decode<DriveResiduals>(bytes); }

std::string EncodeLinks(SessionLoops links) { return Encode(links); }
SessionLoops DecodeLinks(std::string_view bytes) { return Decode<SessionLoops>(bytes); }

}  // namespace parkade

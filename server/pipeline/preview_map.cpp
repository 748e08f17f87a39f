#include "server/pipeline/preview_map.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/files/file.h"
#include "core/log.h"
#include "export/gltf/move_gltf.h"
#include "mapping/mesh/deform_mesh.h"
#include "server/map_folder/kept_links.h"
#include "server/map_folder/map_reader.h"
#include "server/map_folder/stage_cache.h"
#include "slam/georeference/align_points.h"
#include "slam/loops/site_graph.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

constexpr double kInterval = 0.2;              // [s] between poses that are compared
constexpr size_t kMaxBytes = size_t{4} << 30;  // of a .glb

/// Where the drive's poses were and are, in order of time.
void AddKeyframes(const std::vector<TimedPose>& old_poses, const SiteDrive& drive,
                  std::vector<MovedKeyframe>& keyframes) {
  const Rigid3 imu_from_body = drive.rig.body_from_imu.Inverse();
  std::optional<Timestamp> last;
  for (const TimedPose& pose : old_poses) {
    if (last && pose.time - *last < kInterval) continue;
    const std::optional<Rigid3> now = drive.site_from_body_trajectory.At(pose.time);
    if (!now) continue;
    keyframes.push_back({pose.world_from_frame * imu_from_body, *now});
    last = pose.time;
  }
}

/// The old map's .glb with its ground moved, and the lines of the drives that stay.
std::string Encode(const MapReader& old_map, const MeshDeformation& deformation,
                   const Rigid3& site_from_deformed, const std::set<std::string>& drives,
                   const std::optional<SiteDatum>& datum, const std::string& preview) {
  // Ground that only removed drives saw is not shown; if no drive was removed, all of the ground
  // was seen.
  const bool has_lost_drives = drives.size() < old_map.drives().size();
  const auto motion = [&](const Eigen::Vector3d& point) -> std::optional<Eigen::Vector3d> {
    if (has_lost_drives && !deformation.IsSeen(point)) return std::nullopt;
    return site_from_deformed * deformation.Apply(point);
  };
  return MoveGltf(ReadFile(old_map.FileNamed("map_plain.glb"), kMaxBytes), motion, drives, datum,
                  preview);
}

Trajectory OldTrajectory(const MapReader& old_map, const ClosedDrive& drive) {
  const Rigid3 imu_from_body = drive.body_from_imu.Inverse();
  std::vector<TrajectoryState> states;
  for (const TimedPose& pose : ReadTum(old_map.FileOfDrive(drive.name, "trajectory.tum")))
    states.push_back({.time = pose.time, .world_from_body = pose.world_from_frame * imu_from_body});
  return Trajectory(std::move(states));
}

/// The loops of the old map as it closed them; none where it does not say.
LoopClosure OldLoops(const MapReader& old_map, const std::string& drive) {
  if (!old_map.Has(drive + "/loops.bin")) return {};
  const std::optional<std::string> bytes = LastProduct(old_map.FileOfDrive(drive, "loops.bin"));
  return bytes ? DecodeLoops(*bytes) : LoopClosure{};
}

/// The links that the old map was joined by, without those that are rejected now.
std::vector<KeptLink> LinksWithout(const LinkReview& review, const MapReader& old_map,
                                   const std::vector<std::string>& names) {
  const ReviewedLinks reviewed(review, names);
  std::vector<KeptLink> links = ReadKeptLinks(old_map, names);
  std::erase_if(links, [&](const KeptLink& link) {
    const bool is_first = link.drive_a < link.drive_b;
    return reviewed.Rejects(
        is_first ? LinkEnds{link.drive_a, link.keyframe_a, link.drive_b, link.keyframe_b}
                 : LinkEnds{link.drive_b, link.keyframe_b, link.drive_a, link.keyframe_a});
  });
  return links;
}

/// Keyframes are the graph's vertices after the first, which is the world.
JointDeformation DeformWith(const SiteGraph& site, const TriangleMesh& ground) {
  std::vector<FreeKeyframe> keyframes;
  for (size_t i = 1; i < site.graph.vertices.size(); ++i)
    keyframes.push_back({site.before[i], site.graph.vertices[i].world_from_vertex,
                         site.graph.vertices[i].is_fixed});
  std::vector<DeformationMeasurement> measurements;
  for (const PoseGraphEdge& edge : site.graph.edges)
    measurements.push_back({edge.from > 0 ? std::optional(edge.from - 1) : std::nullopt,
                            edge.to - 1, edge.from_from_to, edge.information});
  return DeformJointly(ground, keyframes, measurements);
}

/// A site on Earth stays where it lies as a whole: all its fixes or pins say so, and not its first
/// keyframe.
Rigid3 StayOnEarth(const SiteGraph& site, const std::vector<Rigid3>& poses) {
  Eigen::Matrix3Xd from(3, poses.size()), to(3, poses.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = poses[i].translation;
    to.col(static_cast<Eigen::Index>(i)) = site.before[i + 1].translation;
  }
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(from.cols());
  return AlignYawAndTranslation(from, to, weights, weights);
}

template <typename Encode>
void WritePreview(const BuildContext& context, Encode encode) {
  if (context.scope.preview.empty()) return;
  try {
    const std::optional<std::string> preview = encode();
    if (!preview) return;
    WriteFileAtomically(context.scope.preview, *preview);
    LogInfo("preview written");
  } catch (const Error& error) {
    LogWarning(std::string("there is no preview: ") + error.what());
  }
}

}  // namespace

std::string EncodePreview(const std::filesystem::path& from, const LogHashes& logs,
                          const SiteMap& site) {
  const MapReader old_map(from);
  std::vector<MovedKeyframe> keyframes;
  std::set<std::string> drives;
  for (const SiteDrive& drive : site.drives) {
    if (!old_map.Holds(drive.name, logs)) continue;
    drives.insert(drive.name);
    AddKeyframes(ReadTum(old_map.FileOfDrive(drive.name, "trajectory.tum")), drive, keyframes);
  }
  Require(!keyframes.empty(), ErrorCode::kInvalidInput, "the two maps have no drive in common");
  return Encode(old_map, DeformGround(old_map.ReadGround(), keyframes), Rigid3{}, drives,
                site.datum, "final");
}

std::optional<std::string> EncodeJointPreview(const std::filesystem::path& from,
                                              const LogHashes& logs,
                                              std::span<const ClosedDrive> drives,
                                              const LinkReview& links, const LoopOptions& options) {
  const MapReader old_map(from);
  std::vector<RevisitedDrive> revisited;
  std::vector<std::string> names;
  for (const ClosedDrive& drive : drives) {
    if (!old_map.Holds(drive.name, logs)) continue;
    if (!drive.is_odometry_taken) return std::nullopt;
    names.push_back(drive.name);
    revisited.push_back({*drive.odometry, OldLoops(old_map, drive.name), *drive.loops,
                         OldTrajectory(old_map, drive)});
  }
  if (std::none_of(revisited.begin(), revisited.end(),
                   [](const auto& drive) { return drive.HasChanged(); }))
    return std::nullopt;
  const SiteGraph site = RegraphSite(revisited, LinksWithout(links, old_map, names), options);
  const JointDeformation joint = DeformWith(site, old_map.ReadGround());
  const Rigid3 site_from_joint = old_map.datum() ? StayOnEarth(site, joint.to_from_body) : Rigid3{};
  return Encode(old_map, joint.ground, site_from_joint, {names.begin(), names.end()},
                old_map.datum(), "joint");
}

void PreviewLoops(const BuildContext& context, std::span<const DriveInWork> drives) {
  std::vector<ClosedDrive> closed;
  for (const DriveInWork& drive : drives)
    closed.push_back({drive.log->name(), drive.log->rig().body_from_imu,
                      &drive.odometry.value.odom_from_body, &drive.loops.value,
                      drive.is_odometry_taken});
  const BuildScope& scope = context.scope;
  WritePreview(context, [&] {
    return EncodeJointPreview(scope.from, scope.logs, closed, scope.links, context.options.loops);
  });
}

void PreviewSite(const BuildContext& context, const SiteMap& site) {
  const BuildScope& scope = context.scope;
  WritePreview(context, [&]() -> std::optional<std::string> {
    return EncodePreview(scope.from, scope.logs, site);
  });
}

}  // namespace parkade

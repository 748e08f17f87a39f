#include "server/preview_map.h"

#include <algorithm>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "export/move_gltf.h"
#include "mapping/deform_mesh.h"
#include "server/finished_map.h"

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

}  // namespace

std::string EncodePreview(const std::filesystem::path& from, const SiteMap& site) {
  const FinishedMap old_map(from);
  std::vector<MovedKeyframe> keyframes;
  std::set<std::string> drives;
  for (const SiteDrive& drive : site.drives) {
    if (std::find(old_map.drives().begin(), old_map.drives().end(), drive.name) == old_map.drives().end()) continue;
    drives.insert(drive.name);
    AddKeyframes(ReadTum(old_map.FileOfDrive(drive.name, "trajectory.tum")), drive, keyframes);
  }
  Require(!keyframes.empty(), ErrorCode::kInvalidInput, "the two maps have no drive in common");
  const MeshDeformation deformation = DeformGround(old_map.ReadGround(), keyframes);
  // What only drives saw that have left is not shown; without one that left, all of the ground was seen.
  const bool has_lost_drives = drives.size() < old_map.drives().size();
  const auto motion = [&](const Eigen::Vector3d& point) -> std::optional<Eigen::Vector3d> {
    if (has_lost_drives && !deformation.IsSeen(point)) return std::nullopt;
    return deformation.Apply(point);
  };
  return MoveGltf(ReadFile(old_map.FileNamed("map_plain.glb"), kMaxBytes), motion, drives, site.datum);
}

}  // namespace parkade

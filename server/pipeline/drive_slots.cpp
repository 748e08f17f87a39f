#include "server/pipeline/drive_slots.h"

#include <functional>
#include <nlohmann/json.hpp>

#include "core/options_json.h"
#include "mapping/markings/find_slots.h"
#include "server/map_folder/drive_slots_file.h"
#include "server/pipeline/name_slots.h"

namespace parkade {
namespace {

Keyed<std::vector<ParkingSlot>> Kept(const BuildContext& context, const DriveInWork& drive,
                                     const std::string& ground_key,
                                     const std::function<std::vector<ParkingSlot>()>& find) {
  const MapOptions& options = context.options;
  const std::string key =
      KeyOf({ground_key, drive.refinement.key, "slots", std::to_string(kDriveSlotsVersion),
             OptionsToJson(options.surface).dump(), OptionsToJson(options.mesh).dump(),
             OptionsToJson(options.texture).dump(), OptionsToJson(options.markings).dump()});
  return Cached(context.cache,
                StageFile<std::vector<ParkingSlot>>{drive.log->name() + "/slots.bin",
                                                    EncodeDriveSlots, DecodeDriveSlots},
                key, find);
}

std::vector<ParkingSlot> InOdometry(const DriveInWork& drive, const Trajectory& site_from_body,
                                    const std::vector<ParkingSlot>& slots) {
  const MovedDrive moved{site_from_body, drive.refinement.value.odom_from_body};
  std::vector<ParkingSlot> carried;
  for (const ParkingSlot& slot : slots)
    if (const auto carriage = CarryFrom(slot.Center(), std::span(&moved, 1)))
      carried.push_back(Moved(slot, carriage->after_from_before));
  return carried;
}

/// In the frame that the site would have without other drives: what is found depends on it by a
/// little.
std::vector<ParkingSlot> LookAlone(const MapOptions& options, const DriveInWork& drive,
                                   const SiteGround& ground, size_t index) {
  const Trajectory site_from_body = drive.refinement.value.odom_from_body.Transformed(
      drive.gnss ? drive.gnss->site_from_odom : Rigid3{});
  const std::shared_ptr<const GroundFile>& file = ground.files[index].value;
  StoredGround patches;
  patches.Add(file, 0, site_from_body);
  const DrivenPath path = MakeDrivenPath(0, drive.calibrated->rig(), site_from_body,
                                         file->observation().body_from_ground);
  std::vector<DriveHeights> heights;
  if (!ground.heights.empty()) {
    heights.push_back(ground.heights[index]);
    heights.back().drive = 0;
  }
  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), heights, options.surface);
  const TriangleMesh mesh = MeshSurface(surface, options.mesh);
  const TextureSource source{&*drive.calibrated, &path};
  const GroundTexture texture =
      PaintTexture(mesh, surface, patches, std::span(&source, 1), options.texture);
  const MarkedGround marked{mesh, surface, texture, patches, std::span(&path, 1), 1, {}};
  std::vector<ParkingSlot> slots =
      FindSlots(marked, FindPaint(marked, options.markings.lines), options.markings.slots);
  NameSlots({{drive.log->name(), {site_from_body, drive.odometry.value.odom_from_body}}}, slots);
  return InOdometry(drive, site_from_body, slots);
}

}  // namespace

std::vector<ParkingSlot> FindDriveSlots(const BuildContext& context, const DriveInWork& drive,
                                        const SiteGround& ground, size_t index) {
  return Kept(context, drive, ground.files[index].key,
              [&] { return LookAlone(context.options, drive, ground, index); })
      .value;
}

void KeepDriveSlots(const BuildContext& context, const DriveInWork& drive, const SiteGround& ground,
                    const SiteMap& map) {
  Kept(context, drive, ground.files[0].key, [&] {
    return InOdometry(drive, map.drives[0].site_from_body_trajectory, map.markings.slots);
  });
}

}  // namespace parkade

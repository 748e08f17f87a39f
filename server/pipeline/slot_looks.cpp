#include "server/pipeline/slot_looks.h"

#include "core/error.h"
#include "core/log.h"
#include "server/map_folder/slots_file.h"
#include "server/pipeline/name_slots.h"

namespace parkade {
namespace {

constexpr double kMaxSpread = 0.5;  // [m] by which an earlier map's ground may be bent since
constexpr double kSameGround =
    0.1;  // [m] by which drives may have moved, so that what they saw holds
constexpr const char* kSlotsFile = "slots.geojson";

Trajectory ImuOf(const SiteDrive& drive) {
  std::vector<TrajectoryState> states = drive.site_from_body_trajectory.states();
  for (TrajectoryState& state : states)
    state.world_from_body = state.world_from_body * drive.rig.body_from_imu;
  return Trajectory(std::move(states));
}

/// What the map to start from says of slots.
struct EarlierSlots {
  std::vector<SlotLook> looks;     ///< slots that count, and slots of which only the names do
  std::vector<bool> is_told = {};  ///< by drive of the new map: the looks say all that it saw
};

/// What a stored slot's map says that the drives of a new one saw in it; unseen for the others.
std::vector<SlotState> StatesFor(const SiteMap& map, const StoredSlot& stored) {
  std::vector<SlotState> states;
  for (const SiteDrive& drive : map.drives) {
    const auto found = stored.states.find(drive.name);
    states.push_back(found == stored.states.end() ? SlotState::kUnseen : found->second);
  }
  return states;
}

EarlierSlots SlotsOf(const MapReader& from, const LogHashes& logs, const SiteMap& map) {
  std::vector<MovedDrive> shared;
  SlotLook standing, names{{}, -1, false};
  std::vector<bool> is_told;
  for (const SiteDrive& drive : map.drives) {
    is_told.push_back(from.Holds(drive.name, logs));
    if (!is_told.back()) continue;
    shared.push_back({from.ReadTrajectory(drive.name), ImuOf(drive)});
    standing.drive = static_cast<int>(is_told.size()) - 1;
  }
  for (const StoredSlot& stored : ReadSlots(from.FileNamed(kSlotsFile), from.datum())) {
    const std::optional<Carriage> carriage = CarryFrom(stored.slot.Center(), shared);
    if (!carriage) continue;
    const bool is_as_it_was =
        shared.size() == from.drives().size() && carriage->spread < kMaxSpread;
    ParkingSlot slot = Moved(stored.slot, carriage->after_from_before);
    slot.id = stored.id;
    slot.states =
        carriage->spread < kSameGround ? StatesFor(map, stored) : std::vector<SlotState>();
    (is_as_it_was ? standing : names).slots.push_back(std::move(slot));
  }
  standing.tells_of = is_told;
  if (!names.slots.empty()) is_told.assign(is_told.size(), false);
  return {{std::move(standing), std::move(names)}, std::move(is_told)};
}

/// Nothing where the map to start from has none that can be read.
EarlierSlots FindEarlierSlots(const BuildContext& context, const SiteMap& map) {
  EarlierSlots nothing{{}, std::vector<bool>(map.drives.size())};
  if (!context.from || !context.from->Has(kSlotsFile)) return nothing;
  try {
    return SlotsOf(*context.from, context.scope.logs, map);
  } catch (const Error& error) {
    LogWarning(std::string("slots get new ids: ") + error.what());
    return nothing;
  }
}

}  // namespace

std::vector<SlotLook> LooksBefore(const BuildContext& context,
                                  const std::vector<DriveInWork>& drives, const SiteGround& ground,
                                  const SiteMap& map, Progress& progress) {
  if (!context.options.markings.enabled || !context.options.texture.enabled) return {};
  EarlierSlots earlier = FindEarlierSlots(context, map);
  std::vector<SlotLook> looks = std::move(earlier.looks);
  for (size_t i = 0; i + 1 < drives.size(); ++i) {
    if (earlier.is_told[i]) continue;
    const MovedDrive moved{drives[i].refinement.value.odom_from_body,
                           map.drives[i].site_from_body_trajectory};
    SlotLook look{{}, static_cast<int>(i)};
    for (const ParkingSlot& slot : FindDriveSlots(context, drives[i], ground, i))
      if (const auto carriage = CarryFrom(slot.Center(), std::span(&moved, 1)))
        look.slots.push_back(Moved(slot, carriage->after_from_before));
    looks.push_back(std::move(look));
    progress.Update(static_cast<double>(i + 1) / static_cast<double>(drives.size()));
  }
  return looks;
}

void NameAndKeepSlots(const BuildContext& context, const std::vector<DriveInWork>& drives,
                      const SiteGround& ground, SiteMap& map) {
  std::vector<NamingDrive> naming;
  for (const SiteDrive& drive : map.drives)
    naming.push_back({drive.name, {drive.site_from_body_trajectory, drive.odometry}});
  NameSlots(naming, map.markings.slots);
  if (drives.size() == 1 && context.options.markings.enabled && context.options.texture.enabled)
    KeepDriveSlots(context, drives[0], ground, map);
}

}  // namespace parkade

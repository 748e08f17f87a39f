#include "server/compare/compare_maps.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/math/statistics.h"
#include "core/trajectory.h"
#include "core/yaw.h"
#include "export/changes.h"
#include "server/map_folder/output_folder.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxSlotSigma =
    0.3;  // [m] of the alignment, beyond which a slot may be taken for its neighbor

TrajectoryOffset OffsetOf(const SharedDrive& drive, const Rigid3& to_from_from) {
  std::vector<double> offsets;
  for (const PosePair& pair : drive.poses)
    offsets.push_back((pair.in_to.translation - to_from_from * pair.in_from.translation).norm());
  return {drive.name, Quantile(offsets, 0.5), Quantile(offsets, 0.95), Quantile(offsets, 1)};
}

/// Drives that `others` does not hold.
std::vector<std::string> Without(const MapReader& map, const MapReader& others) {
  std::vector<std::string> rest;
  std::copy_if(map.drives().begin(), map.drives().end(), std::back_inserter(rest),
               [&](const std::string& drive) { return !BothHold(map, others, drive); });
  return rest;
}

double ToMillimeters(double meters) { return std::round(1000 * meters) / 1000; }

Json NumbersOf(const Eigen::Vector3d& vector) {
  return {ToMillimeters(vector.x()), ToMillimeters(vector.y()), ToMillimeters(vector.z())};
}

Json RegionsOf(const SurfaceChanges& ground) {
  Json regions = Json::array();
  for (size_t i = 0; i < ground.regions.size(); ++i) {
    const ChangedRegion& region = ground.regions[i];
    regions.push_back({{"id", i},
                       {"change", ToText(region.change)},
                       {"area", ToMillimeters(region.area)},
                       {"center", NumbersOf(region.center)},
                       {"height_change", ToMillimeters(region.height_change)}});
  }
  return regions;
}

/// A map of an older version of this program has none.
std::vector<StoredSlot> SlotsOf(const MapReader& map) {
  return ReadSlots(map.FileNamed("slots.geojson"), map.datum());
}

Json SlotsToJson(const SlotChanges& slots) {
  Json changed = Json::array();
  for (const SlotChange& change : slots.changed)
    changed.push_back(
        {{"id", change.id}, {"from", ToText(change.from)}, {"to", ToText(change.to)}});
  return {{"kept", slots.num_kept},
          {"added", slots.added},
          {"removed", slots.removed},
          {"changed", changed}};
}

}  // namespace

MapComparison CompareMaps(const MapReader& from, const MapReader& to,
                          const CompareOptions& options) {
  MapComparison comparison;
  const std::vector<SharedDrive> shared = FindSharedDrives(from, to);
  comparison.alignment = AlignMaps(shared, from, to);
  const SiteAlignment& alignment = comparison.alignment;
  comparison.ground = CompareSurfaces(
      from.ReadSurfaceMap(), to.ReadSurfaceMap(),
      {alignment.to_from_from, alignment.horizontal_sigma, alignment.height_sigma}, options);
  if (from.Has("slots.geojson") && to.Has("slots.geojson") &&
      alignment.horizontal_sigma < kMaxSlotSigma)
    comparison.slots = CompareSlots(SlotsOf(from), SlotsOf(to), alignment.to_from_from);
  for (const SharedDrive& drive : shared)
    comparison.trajectories.push_back(OffsetOf(drive, comparison.alignment.to_from_from));
  comparison.added = Without(to, from);
  comparison.removed = Without(from, to);
  comparison.datum = to.datum();
  return comparison;
}

std::string EncodeComparison(const MapComparison& comparison) {
  const SurfaceChanges& ground = comparison.ground;
  const Rigid3& motion = comparison.alignment.to_from_from;
  const auto area = [&](GroundChange change) { return ToMillimeters(ground.AreaOf(change)); };
  Json json;
  json["alignment"] = {{"aligned_by", comparison.alignment.aligned_by},
                       {"translation", NumbersOf(motion.translation)},
                       {"yaw_deg", YawOf(motion.rotation) * 180 / M_PI},
                       {"horizontal_sigma", ToMillimeters(comparison.alignment.horizontal_sigma)},
                       {"height_sigma", ToMillimeters(comparison.alignment.height_sigma)},
                       {"num_links", comparison.alignment.num_links},
                       {"note", comparison.alignment.note}};
  json["free_space"] = {{"unchanged", ToMillimeters(ground.UnchangedArea())},
                        {"gained", area(GroundChange::kFreed) + area(GroundChange::kMapped)},
                        {"lost", area(GroundChange::kBlocked) + area(GroundChange::kUnmapped)},
                        {"freed", area(GroundChange::kFreed)},
                        {"mapped", area(GroundChange::kMapped)},
                        {"blocked", area(GroundChange::kBlocked)},
                        {"unmapped", area(GroundChange::kUnmapped)}};
  json["heights"] = {{"median", ToMillimeters(ground.height.median)},
                     {"rmse", ToMillimeters(ground.height.rmse)},
                     {"percentile_95", ToMillimeters(ground.height.percentile_95)},
                     {"raised", area(GroundChange::kRaised)},
                     {"lowered", area(GroundChange::kLowered)}};
  json["slots"] = SlotsToJson(comparison.slots);
  json["drives"] = {{"added", comparison.added}, {"removed", comparison.removed}};
  json["trajectories"] = Json::array();
  for (const TrajectoryOffset& offset : comparison.trajectories)
    json["trajectories"].push_back({{"drive", offset.drive},
                                    {"median", ToMillimeters(offset.median)},
                                    {"percentile_95", ToMillimeters(offset.percentile_95)},
                                    {"largest", ToMillimeters(offset.largest)}});
  json["regions"] = RegionsOf(ground);
  return json.dump(2) + "\n";
}

void WriteComparison(const MapComparison& comparison, const std::filesystem::path& out) {
  OutputFolder folder(out);
  const Orthophoto image = RenderChanges(comparison.ground);
  WriteFileAtomically(folder.staging() / "changes.json", EncodeComparison(comparison));
  WriteFileAtomically(folder.staging() / "changes.geojson",
                      EncodeChangesGeoJson(comparison.ground, comparison.datum));
  WriteFileAtomically(folder.staging() / "changes.png", EncodePng(image));
  WriteFileAtomically(folder.staging() / "changes.pgw", EncodeWorldFile(image));
  folder.Commit();
}

}  // namespace parkade

#include "server/compare_maps.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/file.h"
#include "core/trajectory.h"
#include "export/changes.h"
#include "server/output_folder.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPosesApart = 0.2;     // [s] of those that are compared
constexpr double kDatumsApart = 20000;  // [m] beyond which two tangent planes are two places

/// The value that a share of all lie below; `values` is not empty.
double Percentile(std::vector<double> values, double share) {
  const auto nth = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

Trajectory ReadDrive(const FinishedMap& map, const std::string& drive) {
  std::vector<TrajectoryState> states;
  for (const TimedPose& pose : ReadTum(map.FileOfDrive(drive, "trajectory.tum")))
    states.push_back({.time = pose.time, .odom_from_body = pose.world_from_frame});
  return Trajectory(std::move(states));
}

/// One instant of a drive in both maps.
struct PosePair {
  Rigid3 in_from, in_to;
};

struct SharedDrive {
  std::string name;
  std::vector<PosePair> poses;
};

SharedDrive PairPoses(const std::string& drive, const FinishedMap& from, const FinishedMap& to) {
  const Trajectory in_from = ReadDrive(from, drive), in_to = ReadDrive(to, drive);
  SharedDrive shared{drive, {}};
  std::optional<Timestamp> last;
  for (const TrajectoryState& state : in_to.states()) {
    if (last && state.time - *last < kPosesApart) continue;
    last = state.time;
    if (const std::optional<Rigid3> pose = in_from.At(state.time))
      shared.poses.push_back({*pose, state.odom_from_body});
  }
  return shared;
}

double YawOf(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d x = rotation * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

/// Medians over all poses: a stretch that moved does not move the rest.
Rigid3 AlignDrives(const std::vector<SharedDrive>& drives) {
  std::vector<PosePair> pairs;
  for (const SharedDrive& drive : drives) pairs.insert(pairs.end(), drive.poses.begin(), drive.poses.end());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  std::vector<double> turns;
  for (const PosePair& pair : pairs) {
    turns.push_back(YawOf(pair.in_to.rotation * pair.in_from.rotation.conjugate()));
    mean += Eigen::Vector2d(std::cos(turns.back()), std::sin(turns.back()));
  }
  const double center = std::atan2(mean.y(), mean.x());
  for (double& turn : turns) turn = std::remainder(turn - center, 2 * M_PI);
  Rigid3 to_from_from;
  to_from_from.rotation = Eigen::AngleAxisd(center + Percentile(turns, 0.5), Eigen::Vector3d::UnitZ());
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> shifts;
    for (const PosePair& pair : pairs)
      shifts.push_back((pair.in_to.translation - to_from_from.rotation * pair.in_from.translation)[axis]);
    to_from_from.translation[axis] = Percentile(std::move(shifts), 0.5);
  }
  return to_from_from;
}

std::vector<SharedDrive> FindSharedDrives(const FinishedMap& from, const FinishedMap& to) {
  std::vector<SharedDrive> shared;
  for (const std::string& drive : to.drives()) {
    if (std::find(from.drives().begin(), from.drives().end(), drive) == from.drives().end()) continue;
    SharedDrive pair = PairPoses(drive, from, to);
    if (!pair.poses.empty()) shared.push_back(std::move(pair));
  }
  return shared;
}

SiteAlignment Align(const std::vector<SharedDrive>& shared, const FinishedMap& from, const FinishedMap& to) {
  if (!shared.empty()) return {AlignDrives(shared), "drives"};
  Require(from.datum() && to.datum(), ErrorCode::kInvalidInput,
          "the two maps share no drive and do not both lie on Earth: nothing says how they lie to each other");
  Require(from.datum()->is_altitude_known && to.datum()->is_altitude_known, ErrorCode::kInvalidInput,
          "the two maps share no drive, and nobody said how high one of them lies: pin it with heights");
  const Rigid3 to_from_from = EarthFromSite(*to.datum()).Inverse() * EarthFromSite(*from.datum());
  Require(to_from_from.translation.norm() < kDatumsApart, ErrorCode::kInvalidInput,
          "the two maps lie " + std::to_string(std::lround(to_from_from.translation.norm() / 1000)) + " km apart");
  return {to_from_from, "datum"};
}

TrajectoryOffset OffsetOf(const SharedDrive& drive, const Rigid3& to_from_from) {
  std::vector<double> offsets;
  for (const PosePair& pair : drive.poses)
    offsets.push_back((pair.in_to.translation - to_from_from * pair.in_from.translation).norm());
  return {drive.name, Percentile(offsets, 0.5), Percentile(offsets, 0.95), Percentile(offsets, 1)};
}

/// Names in `names` that are not in `others`.
std::vector<std::string> Without(const std::vector<std::string>& names, const std::vector<std::string>& others) {
  const std::set<std::string> known(others.begin(), others.end());
  std::vector<std::string> rest;
  std::copy_if(names.begin(), names.end(), std::back_inserter(rest),
               [&](const std::string& name) { return !known.contains(name); });
  return rest;
}

double ToMillimetres(double metres) { return std::round(1000 * metres) / 1000; }

Json NumbersOf(const Eigen::Vector3d& vector) {
  return {ToMillimetres(vector.x()), ToMillimetres(vector.y()), ToMillimetres(vector.z())};
}

Json RegionsOf(const SurfaceChanges& ground) {
  Json regions = Json::array();
  for (size_t i = 0; i < ground.regions.size(); ++i) {
    const ChangedRegion& region = ground.regions[i];
    regions.push_back({{"id", i},
                       {"change", ToText(region.change)},
                       {"area", ToMillimetres(region.area)},
                       {"center", NumbersOf(region.center)},
                       {"height_change", ToMillimetres(region.height_change)}});
  }
  return regions;
}

/// A map of an older version of this program has none.
std::vector<StoredSlot> SlotsOf(const FinishedMap& map) {
  return ReadSlots(map.FileNamed("slots.geojson"), map.datum());
}

Json SlotsToJson(const SlotChanges& slots) {
  Json changed = Json::array();
  for (const SlotChange& change : slots.changed)
    changed.push_back({{"id", change.id}, {"from", ToText(change.from)}, {"to", ToText(change.to)}});
  return {{"kept", slots.num_kept}, {"added", slots.added}, {"removed", slots.removed}, {"changed", changed}};
}

}  // namespace

MapComparison CompareMaps(const FinishedMap& from, const FinishedMap& to, const CompareOptions& options) {
  MapComparison comparison;
  const std::vector<SharedDrive> shared = FindSharedDrives(from, to);
  comparison.alignment = Align(shared, from, to);
  comparison.ground =
      CompareSurfaces(from.ReadSurfaceMap(), to.ReadSurfaceMap(), comparison.alignment.to_from_from, options);
  if (from.Has("slots.geojson") && to.Has("slots.geojson"))
    comparison.slots = CompareSlots(SlotsOf(from), SlotsOf(to), comparison.alignment.to_from_from);
  for (const SharedDrive& drive : shared)
    comparison.trajectories.push_back(OffsetOf(drive, comparison.alignment.to_from_from));
  comparison.added = Without(to.drives(), from.drives());
  comparison.removed = Without(from.drives(), to.drives());
  comparison.datum = to.datum();
  return comparison;
}

std::string EncodeComparison(const MapComparison& comparison) {
  const SurfaceChanges& ground = comparison.ground;
  const Rigid3& motion = comparison.alignment.to_from_from;
  const auto area = [&](GroundChange change) { return ToMillimetres(ground.AreaOf(change)); };
  Json json;
  json["alignment"] = {{"aligned_by", comparison.alignment.aligned_by},
                       {"translation", NumbersOf(motion.translation)},
                       {"yaw_deg", YawOf(motion.rotation) * 180 / M_PI}};
  json["free_space"] = {{"unchanged", ToMillimetres(ground.UnchangedArea())},
                        {"gained", area(GroundChange::kFreed) + area(GroundChange::kMapped)},
                        {"lost", area(GroundChange::kBlocked) + area(GroundChange::kUnmapped)},
                        {"freed", area(GroundChange::kFreed)},
                        {"mapped", area(GroundChange::kMapped)},
                        {"blocked", area(GroundChange::kBlocked)},
                        {"unmapped", area(GroundChange::kUnmapped)}};
  json["heights"] = {{"median", ToMillimetres(ground.height.median)},
                     {"rmse", ToMillimetres(ground.height.rmse)},
                     {"percentile_95", ToMillimetres(ground.height.percentile_95)},
                     {"raised", area(GroundChange::kRaised)},
                     {"lowered", area(GroundChange::kLowered)}};
  json["slots"] = SlotsToJson(comparison.slots);
  json["drives"] = {{"added", comparison.added}, {"removed", comparison.removed}};
  json["trajectories"] = Json::array();
  for (const TrajectoryOffset& offset : comparison.trajectories)
    json["trajectories"].push_back({{"drive", offset.drive},
                                    {"median", ToMillimetres(offset.median)},
                                    {"percentile_95", ToMillimetres(offset.percentile_95)},
                                    {"largest", ToMillimetres(offset.largest)}});
  json["regions"] = RegionsOf(ground);
  return json.dump(2) + "\n";
}

void WriteComparison(const MapComparison& comparison, const std::filesystem::path& out) {
  OutputFolder folder(out);
  const Orthophoto picture = RenderChanges(comparison.ground);
  WriteFileAtomically(folder.staging() / "changes.json", EncodeComparison(comparison));
  WriteFileAtomically(folder.staging() / "changes.geojson", EncodeChangesGeoJson(comparison.ground, comparison.datum));
  WriteFileAtomically(folder.staging() / "changes.png", EncodePng(picture));
  WriteFileAtomically(folder.staging() / "changes.pgw", EncodeWorldFile(picture));
  folder.Commit();
}

}  // namespace parkade

#include "tests/simulator/drives/drive_summary.h"

#include <cinttypes>
#include <cstdio>

#include "core/options_json.h"
#include "tests/simulator/layouts/place_look.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

/// The faults that are not counted by records, in words.
nlohmann::json FaultsOf(const FaultOptions& faults, const DriveCounts& counts) {
  const nlohmann::json all = OptionsToJson(faults), none = OptionsToJson(FaultOptions{});
  nlohmann::json asked = nlohmann::json::object();
  for (const auto& [name, value] : all.items())
    if (value != none[name]) asked[name] = value;
  return {{"asked_for", asked}, {"records_concerned", counts.faults}};
}

}  // namespace

std::string HashOf(const SimulateOptions& options) {
  nlohmann::json json = OptionsToJson(options);
  // Drives that were made before there were other lenses and looks stay as they are.
  if (json["looks"] == SimulateOptions{}.looks) json.erase("looks");
  if (json["rig"]["lens"] == RigOptions{}.lens) json["rig"].erase("lens");
  const std::string text = std::to_string(kSimulatorVersion) + json.dump();
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016" PRIx64, hash);
  return hex;
}

nlohmann::json SummaryOf(const SimulateOptions& options, const DrivePlan& plan,
                         const DriveCounts& counts) {
  const SiteDatum datum = SimulatedDatum();
  return {{"simulator_version", kSimulatorVersion},
          {"options", OptionsToJson(options)},
          {"options_hash", HashOf(options)},
          {"drive",
           {{"length_m", plan.length},
            {"duration_s", plan.motion.Duration()},
            {"max_speed_m_per_s", plan.max_speed},
            {"min_radius_m", plan.min_radius},
            {"returns_to_start", plan.returns_to_start},
            {"reversals", plan.num_reversals},
            {"is_parked", plan.is_parked}}},
          {"look", LookOf(options.looks, options.OfScene().seed).family},
          {"datum",
           {{"latitude_deg", datum.latitude_deg},
            {"longitude_deg", datum.longitude_deg},
            {"altitude", datum.altitude}}},
          {"counts",
           {{"images", counts.images},
            {"image_bytes", counts.image_bytes},
            {"imu", counts.imu},
            {"wheels", counts.wheels},
            {"gnss", counts.gnss}}},
          {"faults", FaultsOf(options.faults, counts)}};
}

}  // namespace parkade::simulator

#include "server/map_folder/slots_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

Json ParseCollection(const std::filesystem::path& file) {
  Json json = Json::parse(ReadFile(file), nullptr, /*allow_exceptions=*/false);
  Require(json.is_object() && json.contains("features") && json["features"].is_array(),
          ErrorCode::kInvalidInput, "'" + file.string() + "' is no GeoJSON FeatureCollection");
  return json;
}

/// The corners of a polygon of four, in meters.
std::array<Eigen::Vector3d, 4> CornersOf(const Json& feature, bool is_in_site,
                                         const std::optional<SiteDatum>& datum) {
  const Json& ring = feature.at("geometry").at("coordinates").at(0);
  Require(ring.size() == 5, ErrorCode::kInvalidInput, "a slot has four corners");
  Require(is_in_site || datum, ErrorCode::kInvalidInput, "slots on Earth need a map on Earth");
  std::array<Eigen::Vector3d, 4> corners;
  for (size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d value(ring[i].at(0).get<double>(), ring[i].at(1).get<double>(),
                                ring[i].at(2).get<double>());
    corners[i] = is_in_site ? value : SiteFromGeodetic(*datum, value.y(), value.x(), value.z());
  }
  return corners;
}

/// Four corners in site, which also maps have that do not know how high they lie on Earth.
std::array<Eigen::Vector3d, 4> CornersIn(const Json& corners_in_site) {
  std::array<Eigen::Vector3d, 4> corners;
  for (size_t i = 0; i < 4; ++i)
    for (size_t axis = 0; axis < 3; ++axis)
      corners[i][static_cast<Eigen::Index>(axis)] = corners_in_site.at(i).at(axis).get<double>();
  return corners;
}

template <typename Named>
Named FindNamed(const std::string& name, std::initializer_list<Named> all) {
  for (const Named value : all)
    if (name == ToText(value)) return value;
  throw Error(ErrorCode::kInvalidInput, "'" + name + "' is unknown");
}

SlotState StateNamed(const std::string& name) {
  return FindNamed(name, {SlotState::kUnseen, SlotState::kFree, SlotState::kOccupied});
}

StoredSlot ReadSlot(const Json& feature, bool is_in_site, const std::optional<SiteDatum>& datum) {
  StoredSlot stored;
  const Json& properties = feature.at("properties");
  stored.id = properties.at("id").get<std::string>();
  stored.slot.corners = properties.contains("corners_m") ? CornersIn(properties["corners_m"])
                                                         : CornersOf(feature, is_in_site, datum);
  stored.slot.kind = FindNamed(properties.at("type").get<std::string>(),
                               {SlotKind::kPerpendicular, SlotKind::kAngled, SlotKind::kParallel});
  stored.slot.angle = properties.at("angle_deg").get<double>() * M_PI / 180;
  stored.slot.confidence = properties.at("confidence").get<double>();
  stored.slot.num_marked_sides = properties.at("marked_sides").get<int>();
  for (const auto& [drive, state] : properties.at("states").items()) {
    stored.states[drive] = StateNamed(state.get<std::string>());
    stored.slot.states.push_back(stored.states[drive]);
  }
  return stored;
}

/// A rectangle in the simulator's form.
TrueSlot RectangleOf(const Json& properties) {
  const Json &center = properties.at("center"), &size = properties.at("size");
  const double yaw = properties.at("yaw").get<double>();
  const Eigen::Vector2d middle(center.at(0).get<double>(), center.at(1).get<double>());
  const Eigen::Vector2d along =
      0.5 * size.at(0).get<double>() * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d across =
      0.5 * size.at(1).get<double>() * Eigen::Vector2d(-std::sin(yaw), std::cos(yaw));
  return {{middle - along - across, middle + along - across, middle + along + across,
           middle - along + across},
          center.at(2).get<double>()};
}

TrueSlot ReadTrueSlot(const Json& feature, bool is_in_site, const std::optional<SiteDatum>& datum) {
  const Json& properties = feature.at("properties");
  TrueSlot slot;
  if (properties.contains("center") && properties.contains("size")) {
    slot = RectangleOf(properties);
  } else {
    const std::array<Eigen::Vector3d, 4> corners = CornersOf(feature, is_in_site, datum);
    for (size_t i = 0; i < 4; ++i) {
      slot.corners[i] = corners[i].head<2>();
      slot.height += corners[i].z() / 4;
    }
  }
  slot.is_occupied = properties.value("is_occupied", false);
  return slot;
}

template <typename Read>
auto ReadAll(const std::filesystem::path& file, const Read& read) {
  const Json json = ParseCollection(file);
  const bool is_in_site = json.value("frame", std::string()) == "site";
  std::vector<decltype(read(json, is_in_site))> all;
  try {
    for (const Json& feature : json["features"]) all.push_back(read(feature, is_in_site));
  } catch (const Json::exception&) {
    throw Error(ErrorCode::kInvalidInput,
                "'" + file.string() + "' holds something else than parking slots");
  }
  return all;
}

}  // namespace

std::vector<StoredSlot> ReadSlots(const std::filesystem::path& file,
                                  const std::optional<SiteDatum>& datum) {
  return ReadAll(file, [&](const Json& feature, bool is_in_site) {
    return ReadSlot(feature, is_in_site, datum);
  });
}

std::vector<TrueSlot> ReadTrueSlots(const std::filesystem::path& file,
                                    const std::optional<SiteDatum>& datum) {
  return ReadAll(file, [&](const Json& feature, bool is_in_site) {
    return ReadTrueSlot(feature, is_in_site, datum);
  });
}

}  // namespace parkade

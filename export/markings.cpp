#include "export/markings.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "export/geojson.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

/// Rounds to so many parts of one, so that the text is short and the same everywhere.
double Rounded(double value, double parts) { return std::round(value * parts) / parts; }

std::string FormatFeature(const Json& properties, const std::string& type,
                          const std::string& coordinates) {
  return R"({"type":"Feature","properties":)" +
         properties.dump(-1, ' ', false, Json::error_handler_t::replace) +
         R"(,"geometry":{"type":")" + type + R"(","coordinates":)" + coordinates + "}}";
}

std::string FormatSlot(const ParkingSlot& slot, const std::vector<std::string>& drives, int level,
                       const std::optional<SiteDatum>& datum) {
  const Eigen::Vector3d center = slot.Center();
  Json states = Json::object(), corners = Json::array();
  for (const Eigen::Vector3d& corner : slot.corners)
    corners.push_back(
        {Rounded(corner.x(), 1000), Rounded(corner.y(), 1000), Rounded(corner.z(), 1000)});
  for (size_t i = 0; i < drives.size() && i < slot.states.size(); ++i)
    states[drives[i]] = ToText(slot.states[i]);
  const Json properties = {{"id", slot.id},
                           {"type", ToText(slot.kind)},
                           {"width_m", Rounded(slot.Width(), 1000)},
                           {"length_m", Rounded(slot.Length(), 1000)},
                           {"angle_deg", Rounded(slot.angle * 180 / std::numbers::pi, 10)},
                           {"level", level},
                           {"height_m", Rounded(center.z(), 1000)},
                           {"confidence", Rounded(slot.confidence, 100)},
                           {"marked_sides", slot.num_marked_sides},
                           {"state", ToText(LatestState(slot))},
                           {"states", states},
                           {"corners_m", corners}};
  return FormatFeature(properties, "Polygon",
                       FormatPolygon({Ring(slot.corners.begin(), slot.corners.end())}, datum));
}

std::string FormatMarking(const RoadMarking& marking, int level,
                          const std::optional<SiteDatum>& datum) {
  const char* color = marking.is_yellow ? "yellow" : "white";
  if (marking.shape == RoadMarking::Shape::kArea) {
    Ring ring(marking.points.begin(), marking.points.end());
    if (SignedArea(ring) < 0) std::reverse(ring.begin(), ring.end());
    return FormatFeature({{"type", "area"}, {"color", color}, {"level", level}}, "Polygon",
                         FormatPolygon({ring}, datum));
  }
  const Json properties = {{"type", "line"},
                           {"color", color},
                           {"width_m", Rounded(marking.width, 100)},
                           {"bounds_slot", marking.is_of_slot},
                           {"level", level}};
  return FormatFeature(properties, "LineString",
                       "[" + FormatPosition(marking.points.front(), datum) + "," +
                           FormatPosition(marking.points.back(), datum) + "]");
}

std::string FormatBump(const SpeedBump& bump, int level, const std::optional<SiteDatum>& datum) {
  const Json properties = {{"type", "speed_bump"},
                           {"height_m", Rounded(bump.height, 1000)},
                           {"length_m", Rounded(bump.length, 100)},
                           {"yaw_deg", Rounded(bump.yaw * 180 / std::numbers::pi, 10)},
                           {"passes", bump.num_passes},
                           {"level", level}};
  return FormatFeature(properties, "Point", FormatPosition(bump.crest, datum));
}

std::string FormatKerb(const Kerb& kerb, int level, const std::optional<SiteDatum>& datum) {
  Json points = Json::array();
  std::string coordinates;
  for (const Eigen::Vector3d& point : kerb.points) {
    points.push_back(
        {Rounded(point.x(), 1000), Rounded(point.y(), 1000), Rounded(point.z(), 1000)});
    coordinates += (coordinates.empty() ? "" : ",") + FormatPosition(point, datum);
  }
  const Json properties = {{"type", "kerb"},
                           {"height_m", Rounded(kerb.height, 1000)},
                           {"height_sigma_m", Rounded(kerb.height_sigma, 1000)},
                           {"length_m", Rounded(kerb.Length(), 100)},
                           {"hidden_m", Rounded(kerb.hidden_length, 100)},
                           {"level", level},
                           {"points_m", points}};
  return FormatFeature(properties, "LineString", "[" + coordinates + "]");
}

}  // namespace

SlotState LatestState(const ParkingSlot& slot) {
  for (auto state = slot.states.rbegin(); state != slot.states.rend(); ++state)
    if (*state != SlotState::kUnseen) return *state;
  return SlotState::kUnseen;
}

std::string EncodeSlotsGeoJson(const std::vector<ParkingSlot>& slots,
                               const std::vector<std::string>& drives,
                               const std::vector<FreeSheet>& sheets,
                               const std::optional<SiteDatum>& datum) {
  std::vector<std::string> features;
  features.reserve(slots.size());
  for (const ParkingSlot& slot : slots)
    features.push_back(FormatSlot(slot, drives, LevelAt(slot.Center().z(), sheets), datum));
  return FormatFeatureCollection(features, datum);
}

std::string EncodeMarkingsGeoJson(const GroundMarkings& markings,
                                  const std::vector<FreeSheet>& sheets,
                                  const std::optional<SiteDatum>& datum) {
  std::vector<std::string> features;
  for (const RoadMarking& marking : markings.markings)
    features.push_back(FormatMarking(marking, LevelAt(marking.points.front().z(), sheets), datum));
  for (const SpeedBump& bump : markings.bumps)
    features.push_back(FormatBump(bump, LevelAt(bump.crest.z(), sheets), datum));
  for (const Kerb& kerb : markings.kerbs)
    features.push_back(FormatKerb(kerb, LevelAt(kerb.points.front().z(), sheets), datum));
  return FormatFeatureCollection(features, datum);
}

}  // namespace parkade

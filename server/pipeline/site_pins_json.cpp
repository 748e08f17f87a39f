#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/geoid.h"
#include "server/map_folder/report_file.h"
#include "server/pipeline/site_pins.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

Json NumbersOf(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Eigen::Vector3d VectorOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// A number, or null in place of an infinite one.
Json RowsOf(const Eigen::Matrix4d& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < 4; ++i) {
    Json& row = rows.emplace_back(Json::array());
    for (Eigen::Index k = 0; k < 4; ++k) row.push_back(matrix(i, k));
  }
  return rows;
}

SitePin PinFromJson(const Json& json) {
  SitePin pin;
  pin.place = {VectorOf(json.at("point")), json.at("latitude_deg").get<double>(),
               json.at("longitude_deg").get<double>(), std::nullopt};
  if (!json.at("height").is_null()) pin.place.height = json.at("height").get<double>();
  for (const Json& anchor : json.at("anchors"))
    pin.anchors.push_back({anchor.at("drive").get<std::string>(),
                           ParseSeconds(anchor.at("time_s").get<std::string>()),
                           VectorOf(anchor.at("point_in_imu"))});
  pin.is_used = json.at("is_used").get<bool>();
  return pin;
}

Json GeoidToJson(const SiteDatum& datum) {
  const std::optional<Geoid> geoid = Geoid::Find();
  if (!geoid) return nullptr;
  return {{"model", geoid->name()},
          {"undulation", geoid->Undulation(datum.latitude_deg, datum.longitude_deg)}};
}

}  // namespace

std::vector<SitePin> ReadPins(const std::filesystem::path& map) {
  const std::filesystem::path file = map / "report.json";
  if (!std::filesystem::exists(file))
    return {};  // the missing map is reported where its odometry is needed
  std::vector<SitePin> pins;
  try {
    const nlohmann::json report = ReadReport(map);
    if (const auto found = report.find("pins"); found != report.end())
      for (const auto& pin : *found) pins.push_back(PinFromJson(pin));
  } catch (const Json::exception&) {
    throw Error(ErrorCode::kInvalidInput, file.string() + " is not the report of a map");
  }
  return pins;
}

Json PinsToJson(const SitePinning& pinning) {
  Json json = Json::array();
  size_t used = 0;
  for (const SitePin& pin : pinning.pins) {
    Json anchors = Json::array();
    for (const PinAnchor& anchor : pin.anchors)
      anchors.push_back({{"drive", anchor.drive},
                         {"time_s", ToDecimalSeconds(anchor.time)},
                         {"point_in_imu", NumbersOf(anchor.point_in_imu)}});
    const bool has_residual = pinning.fit && pin.is_used;
    json.push_back(
        {{"point", NumbersOf(pin.place.point_in_site)},
         {"latitude_deg", pin.place.latitude_deg},
         {"longitude_deg", pin.place.longitude_deg},
         {"height", pin.place.height ? Json(*pin.place.height) : Json(nullptr)},
         {"is_used", pin.is_used},
         {"residual", has_residual ? NumbersOf(pinning.fit->residuals[used]) : Json(nullptr)},
         {"anchors", anchors}});
    used += pin.is_used ? 1 : 0;
  }
  return json;
}

Json GeoreferenceToJson(const SiteMap& map, const SitePinning& pinning) {
  if (!map.datum) return nullptr;
  Json json = {{"source", pinning.fit ? "pins" : "gnss"},
               {"heights", map.datum->is_altitude_known ? "ellipsoidal" : "unknown"},
               {"geoid", GeoidToJson(*map.datum)}};
  if (map.placement) {
    json["centre"] = NumbersOf(map.placement->center);
    json["position_sigma"] = NumbersOf(map.placement->PositionSigma(map.placement->center));
    json["yaw_sigma"] = map.placement->YawSigma();
    json["covariance"] = RowsOf(map.placement->covariance);
  }
  if (pinning.fit)
    json["largest_residual"] = pinning.fit->residuals[pinning.fit->WorstPin()].norm();
  if (pinning.pinned_from_gnss)
    json["pins_from_gnss"] = {{"position", NumbersOf(pinning.pinned_from_gnss->translation)},
                              {"yaw", LogSo3(pinning.pinned_from_gnss->rotation).z()}};
  return json;
}

}  // namespace parkade

#include "server/map_folder/kerbs_file.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

/// Calls `read(feature, is_in_site)` for every kerb of a GeoJSON.
template <typename Read>
void ReadAll(const std::filesystem::path& file, const Read& read) {
  const Json json = Json::parse(ReadFile(file), nullptr, /*allow_exceptions=*/false);
  Require(json.is_object() && json.contains("features") && json["features"].is_array(),
          ErrorCode::kInvalidInput, "'" + file.string() + "' is no GeoJSON FeatureCollection");
  const bool is_in_site = json.value("frame", std::string()) == "site";
  try {
    for (const Json& feature : json["features"])
      if (feature.at("properties").value("type", std::string()) == "kerb")
        read(feature, is_in_site);
  } catch (const Json::exception&) {
    throw Error(ErrorCode::kInvalidInput,
                "'" + file.string() + "' holds kerbs that cannot be read");
  }
}

Eigen::Vector3d PointOf(const Json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

}  // namespace

std::vector<Kerb> ReadKerbs(const std::filesystem::path& file) {
  std::vector<Kerb> kerbs;
  ReadAll(file, [&](const Json& feature, bool) {
    const Json& properties = feature.at("properties");
    Kerb& kerb = kerbs.emplace_back();
    for (const Json& point : properties.at("points_m")) kerb.points.push_back(PointOf(point));
    kerb.height = properties.at("height_m").get<double>();
    kerb.height_sigma = properties.at("height_sigma_m").get<double>();
    kerb.hidden_length = properties.value("hidden_m", 0.0);
  });
  return kerbs;
}

std::vector<TrueKerb> ReadTrueKerbs(const std::filesystem::path& file,
                                    const std::optional<SiteDatum>& datum) {
  std::vector<TrueKerb> kerbs;
  ReadAll(file, [&](const Json& feature, bool is_in_site) {
    const Json& properties = feature.at("properties");
    const bool is_in_meters = is_in_site || properties.contains("line");
    Require(is_in_meters || datum, ErrorCode::kInvalidInput, "kerbs on Earth need a map on Earth");
    const Json& line =
        properties.contains("line") ? properties["line"] : feature.at("geometry").at("coordinates");
    std::vector<Eigen::Vector3d> points;
    for (const Json& point : line) {
      const Eigen::Vector3d value = PointOf(point);
      points.push_back(is_in_meters ? value
                                    : SiteFromGeodetic(*datum, value.y(), value.x(), value.z()));
    }
    for (std::size_t i = 1; i < points.size(); ++i)
      kerbs.push_back({points[i - 1], points[i], properties.at("height_m").get<double>()});
  });
  return kerbs;
}

}  // namespace parkade

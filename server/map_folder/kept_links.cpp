#include "server/map_folder/kept_links.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

Eigen::Vector3d VectorOf(const Json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

Matrix6d InformationOf(const Json& upper_triangle) {
  Matrix6d information;
  size_t next = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      information(row, column) = information(column, row) = upper_triangle.at(next++).get<double>();
  return information;
}

void AddLinks(const Json& pair, const std::vector<std::string>& names,
              std::vector<KeptLink>& links) {
  const auto index_of = [&](const char* key) -> std::optional<size_t> {
    const auto found = std::find(names.begin(), names.end(), pair.at(key).get<std::string>());
    return found == names.end() ? std::nullopt
                                : std::optional(static_cast<size_t>(found - names.begin()));
  };
  const std::optional<size_t> a = index_of("a"), b = index_of("b");
  if (!a || !b) return;
  for (const Json& link : pair.at("links")) {
    if (link.at("weight").get<double>() < 0.5 || !link.contains("information")) continue;
    links.push_back(
        {*a,
         *b,
         link.at("place_a").get<size_t>(),
         link.at("place_b").get<size_t>(),
         {ExpSo3(VectorOf(link.at("rotation_vector"))), VectorOf(link.at("translation"))},
         InformationOf(link.at("information"))});
  }
}

}  // namespace

std::vector<KeptLink> ReadKeptLinks(const MapReader& map, const std::vector<std::string>& names) {
  std::vector<KeptLink> links;
  try {
    const Json report = Json::parse(ReadFile(map.FileNamed("report.json")));
    if (!report.contains("join")) return links;
    for (const Json& pair : report.at("join").at("pairs")) AddLinks(pair, names, links);
  } catch (const Json::exception&) {
    throw Error(ErrorCode::kInvalidInput, "the links in report.json cannot be read");
  }
  return links;
}

}  // namespace parkade

#include "server/jobs/pictures/picture_times.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/foreign_json.h"

namespace parkade {

size_t PictureTimes::NumberOf(const std::string& camera) const {
  std::string known;
  for (size_t i = 0; i < cameras.size(); ++i) {
    if (cameras[i].name == camera) return i;
    known += (known.empty() ? "" : ", ") + cameras[i].name;
  }
  throw Error(ErrorCode::kNotFound, "the drive has no camera '" + camera + "', it has " +
                                        (known.empty() ? "none" : known));
}

PictureTimes ParsePictureTimes(const std::string& index) {
  try {
    PictureTimes found;
    const nlohmann::json parsed = ParseForeignJson(index);
    for (const nlohmann::json& camera : parsed.at("cameras")) {
      PictureTimes::Camera& added = found.cameras.emplace_back();
      added.name = camera.at("name");
      for (const nlohmann::json& time : camera.at("times"))
        added.times.push_back({time.get<std::int64_t>()});
      Require(std::is_sorted(added.times.begin(), added.times.end()), ErrorCode::kInvalidInput,
              "the index of pictures is not in order of time");
    }
    return found;
  } catch (const nlohmann::json::exception&) {
    throw Error(ErrorCode::kInvalidInput, "the index of pictures is damaged");
  }
}

std::optional<Timestamp> NearestTime(const std::vector<Timestamp>& times, Timestamp time,
                                     double patience) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  std::optional<Timestamp> nearest;
  if (after != times.end()) nearest = *after;
  if (after != times.begin() && (!nearest || time - *std::prev(after) <= *nearest - time))
    nearest = *std::prev(after);
  if (!nearest || std::abs(*nearest - time) > patience) return std::nullopt;
  return nearest;
}

}  // namespace parkade

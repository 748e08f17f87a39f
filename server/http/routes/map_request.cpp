#include "server/http/routes/map_request.h"

#include <algorithm>

#include "core/error.h"
#include "server/http/routes/json_body.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxPins = 1000;
constexpr std::size_t kMaxBytes = std::size_t{1} << 20;  // loops of a site with hundreds of drives

/// Words that the worker takes on its command line, where a dash begins an option.
std::vector<std::string> WordsIn(const Json& object, const char* key) {
  std::vector<std::string> words = TextsIn(object, key).value_or(std::vector<std::string>());
  for (const std::string& word : words)
    Require(!word.empty() && !word.starts_with('-'), ErrorCode::kInvalidInput,
            std::string("\"") + key + "\" is a list of ids");
  return words;
}

/// As it was written, to the last digit.
std::string NumberIn(const Json& pin, const char* key) {
  Require(RealIn(pin, key).has_value(), ErrorCode::kInvalidInput,
          std::string("a pin's \"") + key + "\" is a number");
  return pin.at(key).dump();
}

/// A pin as the worker takes it: [DRIVE:]X,Y,Z=LAT,LON[,HEIGHT].
std::string PinOf(const Json& pin) {
  RequireObject(pin, "a pin", {"point", "latitude", "longitude", "height", "drive"});
  Require(pin.contains("point"), ErrorCode::kInvalidInput, "a pin has a \"point\"");
  PointOf(pin.at("point"));
  const auto drive = TextIn(pin, "drive");
  Require(drive != "", ErrorCode::kInvalidInput, "a pin's \"drive\" is the name of one");
  const Json& point = pin.at("point");
  std::string text = drive ? *drive + ":" : "";
  text += point[0].dump() + "," + point[1].dump() + "," + point[2].dump() + "=";
  text += NumberIn(pin, "latitude") + "," + NumberIn(pin, "longitude");
  if (RealIn(pin, "height")) text += "," + NumberIn(pin, "height");
  return text;
}

std::vector<std::string> PinsOf(const Json& value) {
  Require(value.is_array() && value.size() <= kMaxPins, ErrorCode::kInvalidInput,
          "\"pins\" is a list of at most " + std::to_string(kMaxPins) + " pins");
  std::vector<std::string> pins;
  std::transform(value.begin(), value.end(), std::back_inserter(pins), PinOf);
  return pins;
}

}  // namespace

MapRequest ReadMapRequest(const httplib::ContentReader& body) {
  const Json json = ReadObject(
      body,
      {"drives", "from", "reject_loops", "force_loops", "reject_links", "force_links", "pins"},
      kMaxBytes);
  MapRequest request;
  request.drives = WordsIn(json, "drives");
  request.review.from_version = IntegerIn(json, "from");
  request.review.rejected_loops = WordsIn(json, "reject_loops");
  request.review.forced_loops = WordsIn(json, "force_loops");
  request.review.rejected_links = WordsIn(json, "reject_links");
  request.review.forced_links = WordsIn(json, "force_links");
  if (const auto pins = json.find("pins"); pins != json.end() && !pins->is_null())
    request.review.pins = PinsOf(*pins);
  const MapReview& review = request.review;
  const bool decides = !review.rejected_loops.empty() || !review.forced_loops.empty() ||
                       !review.rejected_links.empty() || !review.forced_links.empty() ||
                       review.pins;
  Require(!decides || review.from_version, ErrorCode::kInvalidInput,
          "loops, links and pins are those of a version: name it in \"from\"");
  return request;
}

}  // namespace parkade

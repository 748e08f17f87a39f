#include "server/http/routes/basemap.h"

#include <httplib.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/http/file_response.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileAddress = "/basemap.pmtiles";
constexpr std::string_view kMagic = "PMTiles\x03";  // and the version

bool IsTiles(const std::string& source) {
  return source.starts_with("https://") || source.starts_with("http://");
}

/// "https://HOST" of an address; nothing else of it goes into a header.
std::string OriginOf(const std::string& tiles) {
  const size_t host = tiles.find("://") + 3;
  std::string origin = tiles.substr(0, tiles.find('/', host));
  constexpr const char* kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-:[]";
  Require(origin.size() > host && origin.find_first_not_of(kAllowed, host) == std::string::npos,
          ErrorCode::kUsage, "the basemap's address has no host: " + tiles);
  for (const char* part : {"{z}", "{x}", "{y}"})
    Require(tiles.find(part) != std::string::npos, ErrorCode::kUsage,
            "the basemap's address lacks " + std::string(part) + ": " + tiles);
  return origin;
}

void CheckPmtiles(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string magic(kMagic.size(), '\0');
  stream.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  Require(
      stream && magic == kMagic, ErrorCode::kUsage,
      "the basemap is no readable file of PMTiles 3, and no address of tiles: " + file.string());
}

/// Changes when the file does; a basemap may have gigabytes, which nobody reads for a hash.
std::string TagOf(const fs::path& file) {
  const auto age = fs::last_write_time(file).time_since_epoch();
  return std::to_string(fs::file_size(file)) + "-" +
         std::to_string(std::chrono::duration_cast<std::chrono::nanoseconds>(age).count());
}

}  // namespace

Basemap::Basemap(const BasemapOptions& options) {
  nlohmann::json basemap;  // null: none
  if (IsTiles(options.source)) {
    origin_ = OriginOf(options.source);
    basemap = {{"tiles", options.source}, {"attribution", options.attribution}};
  } else if (!options.source.empty()) {
    file_ = options.source;
    CheckPmtiles(file_);
    basemap = {{"pmtiles", kFileAddress}, {"attribution", options.attribution}};
  }
  description_ = nlohmann::json{{"basemap", basemap}}.dump();
}

bool Basemap::Send(const httplib::Request& request, httplib::Response& response) const {
  if (request.method != "GET" && request.method != "HEAD") return false;
  if (request.path == "/viewer.json") {
    response.set_header("Cache-Control", "no-cache");
    response.set_content(description_, "application/json");
    return true;
  }
  if (file_.empty() || request.path != kFileAddress) return false;
  SendFile(request, response,
           {.path = file_,
            .bytes = static_cast<std::int64_t>(fs::file_size(file_)),
            .sha256 = TagOf(file_),
            .content_type = "application/vnd.pmtiles",
            .cache_control = "no-cache"});
  return true;
}

}  // namespace parkade

#pragma once

#include <filesystem>
#include <string>

#include "server/http/basemap_options.h"

namespace httplib {
struct Request;
struct Response;
}  // namespace httplib

namespace parkade {

/// Answers /viewer.json, by which the page learns of the basemap, and /basemap.pmtiles.
class Basemap {
 public:
  /// Throws Error{kUsage} where the source is neither.
  explicit Basemap(const BasemapOptions& options);

  /// Answers GET and HEAD; false when the address is another one.
  bool Send(const httplib::Request& request, httplib::Response& response) const;

  /// "https://HOST", where pages ask for tiles elsewhere; else empty.
  const std::string& origin() const { return origin_; }

 private:
  std::string description_;  ///< the body of /viewer.json
  std::string origin_;
  std::filesystem::path file_;  ///< empty: none
};

}  // namespace parkade

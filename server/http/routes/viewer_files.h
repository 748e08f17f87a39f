#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace httplib {
struct Request;
struct Response;
}  // namespace httplib

namespace parkade {

/// The built viewer, read and packed once at the start: a request names an entry of a table,
/// never a path. Every place that the page has an address for gets the page.
class ViewerFiles {
 public:
  /// Reads everything below `root`, at most 64 MiB. An empty or missing folder
  /// gives an empty table.
  explicit ViewerFiles(const std::filesystem::path& root);

  /// Answers GET and HEAD for the page and its files; false when the address is
  /// not the viewer's.
  bool Send(const httplib::Request& request, httplib::Response& response) const;

  /// The page, with status 404, for a person who asked for an address that leads nowhere: it says
  /// so, and where to go on. False for programs, and below /api/.
  bool SendForLostPerson(const httplib::Request& request, httplib::Response& response) const;

 private:
  struct File {
    std::string content;
    std::string gzip;  ///< the same, packed; empty where that does not help
    std::string content_type;
    std::string etag;
    std::string cache_control;
  };

  static void SendFile(const File& file, const httplib::Request& request,
                       httplib::Response& response, int status);

  std::map<std::string, File> files_;  ///< by path, "/assets/index-1a2b3c4d.js"
};

}  // namespace parkade

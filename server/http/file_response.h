#pragma once

#include <httplib.h>

#include <filesystem>
#include <functional>
#include <string>

namespace parkade {

/// A file as it is handed out.
struct ServedFile {
  std::filesystem::path path;
  std::int64_t bytes = 0;
  std::string sha256;  ///< its entity tag; empty for a file that still grows
  std::string content_type;
  std::string cache_control;
  /// Sums of its pieces (server/store/disk/file_sums.h): what has changed on the disk is not sent
  /// then, and `on_damage` is told. Empty: not checked.
  std::string pieces = {};
  std::function<void()> on_damage = {};
};

/// True when the client's If-None-Match names `etag`; the answer is 304 then.
bool SendNotModified(const httplib::Request& request, httplib::Response& response,
                     const std::string& etag, const std::string& cache_control);

/// Sends the file, or the one range of it that was asked for, straight from the
/// disk. Answers 200, 206, 304; throws HttpError{416}, HttpError{500, "damaged"} where the store
/// lacks it or the first piece has changed on the disk. Where a later one has, the connection is
/// closed before it: the client sees that it has not got the whole.
void SendFile(const httplib::Request& request, httplib::Response& response, const ServedFile& file);

}  // namespace parkade

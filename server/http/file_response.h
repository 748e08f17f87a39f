#pragma once

#include <httplib.h>

#include <filesystem>
#include <string>

namespace parkade {

/// A file as it is handed out.
struct ServedFile {
  std::filesystem::path path;
  std::int64_t bytes = 0;
  std::string sha256;  ///< its entity tag; empty for a file that still grows
  std::string content_type;
  std::string cache_control;
};

/// True when the client's If-None-Match names `etag`; the answer is 304 then.
bool SendNotModified(const httplib::Request& request, httplib::Response& response,
                     const std::string& etag, const std::string& cache_control);

/// Sends the file, or the one range of it that was asked for, straight from the
/// disk. Answers 200, 206, 304; throws HttpError{416}, Error{kInternal} when the
/// file is not what the store says.
void SendFile(const httplib::Request& request, httplib::Response& response, const ServedFile& file);

}  // namespace parkade

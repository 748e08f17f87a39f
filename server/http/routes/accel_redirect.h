#pragma once

#include <httplib.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "server/http/file_response.h"

namespace parkade {

/// Leaves the sending of published files to nginx, which reads them from the disk itself
/// (X-Accel-Redirect). What the service sends itself is compared with its sums on the way; here a
/// file is read whole and compared before it is handed over the first time, again after an hour,
/// and whenever the filesystem says that it was touched. Thread-safe.
class AccelRedirect {
 public:
  /// `prefix` is nginx' internal location of the data directory, "/NAME/"; empty: nothing is handed
  /// over. Requests for `proxy_host` come through nginx.
  AccelRedirect(std::string prefix, std::string proxy_host)
      : prefix_(std::move(prefix)), proxy_host_(std::move(proxy_host)) {}

  /// True where nginx asks for a file that can be checked.
  bool IsFor(const httplib::Request& request, const ServedFile& file) const;

  /// Names the file, `path` in the data directory, to nginx, which answers ranges too. Answers 200,
  /// 304; throws HttpError{500, "damaged"} where the file is not what was published.
  void Send(const httplib::Request& request, httplib::Response& response, const ServedFile& file,
            const std::string& path);

 private:
  /// What changes whenever a file is written or replaced.
  struct Stamp {
    bool operator==(const Stamp&) const = default;
    std::uint64_t device = 0, inode = 0;
    std::int64_t bytes = 0, changed_seconds = 0, changed_nanoseconds = 0;
  };
  struct Check {
    Stamp stamp;
    std::chrono::steady_clock::time_point time;
  };
  static Stamp StampOf(const std::filesystem::path& file);
  bool IsWhole(const ServedFile& file);

  const std::string prefix_, proxy_host_;
  std::mutex mutex_;
  std::map<std::string, Check> checks_;  ///< by path; guarded by mutex_
};

}  // namespace parkade

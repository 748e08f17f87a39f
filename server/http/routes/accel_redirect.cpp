#include "server/http/routes/accel_redirect.h"

#include <sys/stat.h>

#include "server/http/host_check.h"
#include "server/http/problem.h"
#include "server/store/disk/file_sums.h"

namespace parkade {
namespace {

constexpr std::chrono::hours kTrusted{1};
constexpr size_t kMaxChecks = 100'000;  // remembered; a site of 100 ha has some thousand files

}  // namespace

bool AccelRedirect::IsFor(const httplib::Request& request, const ServedFile& file) const {
  return !prefix_.empty() && !file.pieces.empty() &&
         NamesHost(request.get_header_value("Host"), proxy_host_);
}

void AccelRedirect::Send(const httplib::Request& request, httplib::Response& response,
                         const ServedFile& file, const std::string& path) {
  const std::string etag = '"' + file.sha256 + '"';
  if (SendNotModified(request, response, etag, file.cache_control)) return;
  if (!IsWhole(file)) {
    if (file.on_damage) file.on_damage();
    throw HttpError(
        {500, "damaged",
         "the stored file '" + file.path.filename().string() + "' is damaged or missing"});
  }
  response.status = 200;
  response.set_header("ETag", etag);
  response.set_header("Cache-Control", file.cache_control);
  response.set_header("X-Accel-Redirect", prefix_ + path);
  response.set_content("", file.content_type);
}

AccelRedirect::Stamp AccelRedirect::StampOf(const std::filesystem::path& file) {
  struct stat info {};
  if (::lstat(file.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return {};
  return {info.st_dev, info.st_ino, info.st_size, info.st_ctim.tv_sec, info.st_ctim.tv_nsec};
}

bool AccelRedirect::IsWhole(const ServedFile& file) {
  const Stamp stamp = StampOf(file.path);
  if (stamp == Stamp()) return false;
  const auto now = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(mutex_);
    const auto found = checks_.find(file.path);
    if (found != checks_.end() && found->second.stamp == stamp &&
        now - found->second.time < kTrusted)
      return true;
  }
  if (!HasPieces(file.path, file.bytes, file.pieces)) return false;
  const std::lock_guard lock(mutex_);
  if (checks_.size() >= kMaxChecks) checks_.clear();
  checks_[file.path] = {stamp, now};
  return true;
}

}  // namespace parkade

#include "server/http/routes/viewer_files.h"

#include <httplib.h>

#include <algorithm>
#include <array>

#include "core/file.h"
#include "core/log.h"
#include "core/sha256.h"
#include "server/http/file_response.h"
#include "server/http/json_view.h"
#include "server/http/problem.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxTotalBytes = size_t{64} << 20;
constexpr const char* kIndex = "/index.html";

/// Addresses of the page: the viewer keeps its state in the query ("/?site=lot").
constexpr std::array<std::string_view, 1> kPageAddresses = {"/"};

bool IsPageAddress(std::string_view path) {
  return std::find(kPageAddresses.begin(), kPageAddresses.end(), path) != kPageAddresses.end();
}

}  // namespace

ViewerFiles::ViewerFiles(const fs::path& root) {
  if (root.empty() || !fs::is_directory(root)) return;
  size_t total = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    if (!fs::is_regular_file(entry.symlink_status())) continue;
    const std::string name = "/" + entry.path().lexically_relative(root).generic_string();
    File file;
    file.content = ReadFile(entry.path(), kMaxTotalBytes - total);
    total += file.content.size();
    file.content_type = ContentTypeOf(name);
    file.etag = '"' + Sha256Of(file.content) + '"';
    // The build puts a hash into the names below assets/.
    file.cache_control =
        name.starts_with("/assets/") ? "public, max-age=31536000, immutable" : "no-cache";
    files_.emplace(name, std::move(file));
  }
  LogInfo("viewer files=" + std::to_string(files_.size()) + " bytes=" + std::to_string(total));
}

bool ViewerFiles::Send(const httplib::Request& request, httplib::Response& response) const {
  if (request.method != "GET" && request.method != "HEAD") return false;
  const bool is_page = IsPageAddress(request.path);
  const auto found = files_.find(is_page ? kIndex : request.path);
  if (found == files_.end()) {
    if (is_page)
      SendProblem(response, {404, "not_found",
                             "the viewer is not installed: build it with scripts/build_web.sh"});
    return is_page;
  }
  const File& file = found->second;
  if (SendNotModified(request, response, file.etag, file.cache_control)) return true;
  response.status = 200;
  response.set_header("ETag", file.etag);
  response.set_header("Cache-Control", file.cache_control);
  response.set_content(file.content, file.content_type);
  return true;
}

}  // namespace parkade

#include "server/http/routes/viewer_files.h"

#include <httplib.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/files/file.h"
#include "core/files/sha256.h"
#include "core/log.h"
#include "server/http/file_response.h"
#include "server/http/json_view.h"
#include "server/http/problem.h"
#include "server/http/request_head.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxTotalBytes = size_t{64} << 20;
constexpr const char* kIndex = "/index.html";

/// First segments of the page's addresses: web/src/shell/routes.ts says what each shows.
constexpr std::array<std::string_view, 7> kPlaces = {"sites",  "drives", "jobs",    "rigs",
                                                     "upload", "review", "settings"};

bool IsPageAddress(std::string_view path) {
  if (path == "/") return true;
  const std::string_view place = path.substr(1, path.find('/', 1) - 1);
  return std::find(kPlaces.begin(), kPlaces.end(), place) != kPlaces.end();
}

/// Pictures are small already.
bool IsCompressible(const std::string& content_type) {
  return content_type.starts_with("text/") || content_type.starts_with("application/") ||
         content_type == "image/svg+xml";
}

/// The content as gzip (RFC 1952) has it; empty where that is no smaller.
std::string Gzip(const std::string& content) {
  constexpr int kGzipWindow = 15 + 16;
  z_stream stream;
  std::memset(&stream, 0, sizeof(stream));
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, 9,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    return {};
  std::string packed(content.size(), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));  // only read
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const bool is_smaller = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  packed.resize(is_smaller ? stream.total_out : 0);
  deflateEnd(&stream);
  return packed;
}

/// Whether an Accept-Encoding names gzip, and not with a weight of 0.
bool TakesGzip(const httplib::Request& request) {
  const std::string accepted = request.get_header_value(kEncodingField);
  const size_t at = accepted.find("gzip");
  if (at == std::string::npos) return false;
  const std::string_view rest = std::string_view(accepted).substr(at + 4);
  const std::string_view weight = rest.substr(0, rest.find(','));
  return weight.find_first_of("123456789") != std::string_view::npos ||
         weight.find("q=") == std::string_view::npos;
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
    if (IsCompressible(file.content_type)) file.gzip = Gzip(file.content);
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
  if (!file.gzip.empty()) response.set_header("Vary", "Accept-Encoding");
  if (!SendNotModified(request, response, file.etag, file.cache_control))
    SendFile(file, request, response, 200);
  return true;
}

bool ViewerFiles::SendForLostPerson(const httplib::Request& request,
                                    httplib::Response& response) const {
  const auto page = files_.find(kIndex);
  const bool is_person = request.get_header_value("Accept").find("text/html") != std::string::npos;
  if (page == files_.end() || !is_person || request.path.starts_with("/api/") ||
      (request.method != "GET" && request.method != "HEAD"))
    return false;
  response.set_header("Vary", "Accept, Accept-Encoding");
  SendFile(page->second, request, response, 404);
  return true;
}

void ViewerFiles::SendFile(const File& file, const httplib::Request& request,
                           httplib::Response& response, int status) {
  response.status = status;
  response.set_header("ETag", file.etag);
  response.set_header("Cache-Control", file.cache_control);
  const bool is_packed = !file.gzip.empty() && TakesGzip(request);
  if (is_packed) response.set_header("Content-Encoding", "gzip");
  response.set_content(is_packed ? file.gzip : file.content, file.content_type);
}

}  // namespace parkade

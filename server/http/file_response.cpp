#include "server/http/file_response.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <memory>
#include <optional>

#include "core/error.h"
#include "server/http/byte_range.h"
#include "server/http/problem.h"
#include "server/http/request_head.h"

namespace parkade {
namespace {

constexpr size_t kPieceBytes = 131072;

class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path)
      : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)) {}
  ~OpenFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool HasAtLeast(std::int64_t bytes) const {
    struct stat info {};
    return fd_ >= 0 && ::fstat(fd_, &info) == 0 && S_ISREG(info.st_mode) && info.st_size >= bytes;
  }

  /// Passes a piece on. Returns false at the end, on errors and when the client is gone.
  bool SendPiece(std::int64_t offset, size_t length, httplib::DataSink& sink) const {
    std::vector<char> piece(std::min(length, kPieceBytes));
    const ssize_t size = ::pread(fd_, piece.data(), piece.size(), offset);
    return size > 0 && sink.write(piece.data(), static_cast<size_t>(size));
  }

 private:
  int fd_;
};

bool NamesTag(const std::string& field, const std::string& etag) {
  return field == "*" ||
         field.find(etag) != std::string::npos;  // tags are quoted: no part of one is another
}

std::optional<ByteRange> RangeFor(const httplib::Request& request, const ServedFile& file,
                                  const std::string& etag) {
  if (request.method != "GET" || !request.has_header(kRangeField)) return std::nullopt;
  const bool is_other_version =
      request.has_header("If-Range") && request.get_header_value("If-Range") != etag;
  if (is_other_version) return std::nullopt;
  return ParseByteRange(request.get_header_value(kRangeField), file.bytes);
}

}  // namespace

bool SendNotModified(const httplib::Request& request, httplib::Response& response,
                     const std::string& etag, const std::string& cache_control) {
  if (!request.has_header("If-None-Match") ||
      !NamesTag(request.get_header_value("If-None-Match"), etag))
    return false;
  response.status = 304;
  response.set_header("ETag", etag);
  response.set_header("Cache-Control", cache_control);
  return true;
}

void SendFile(const httplib::Request& request, httplib::Response& response,
              const ServedFile& file) {
  const std::string etag = file.sha256.empty() ? "" : '"' + file.sha256 + '"';
  if (!etag.empty() && SendNotModified(request, response, etag, file.cache_control)) return;
  const auto open_file = std::make_shared<OpenFile>(file.path);
  Require(open_file->HasAtLeast(file.bytes), ErrorCode::kInternal,
          "the store lacks the file '" + file.path.filename().string() + "'");

  std::optional<ByteRange> range;
  try {
    range = RangeFor(request, file, etag);
  } catch (const HttpError&) {
    response.set_header("Content-Range", "bytes */" + std::to_string(file.bytes));
    throw;
  }
  response.status = range ? 206 : 200;
  if (!etag.empty()) response.set_header("ETag", etag);
  response.set_header("Cache-Control", file.cache_control);
  if (request.method != "HEAD")
    response.set_header("Accept-Ranges", "bytes");  // the library adds it to HEAD
  const ByteRange part = range.value_or(ByteRange{0, file.bytes});
  if (range)
    response.set_header("Content-Range", "bytes " + std::to_string(part.first) + "-" +
                                             std::to_string(part.first + part.length - 1) + "/" +
                                             std::to_string(file.bytes));
  if (part.length == 0) {
    response.set_content("", file.content_type);
    return;
  }
  response.set_content_provider(
      static_cast<size_t>(part.length), file.content_type,
      [open_file, part](size_t offset, size_t length, httplib::DataSink& sink) {
        return open_file->SendPiece(part.first + static_cast<std::int64_t>(offset), length, sink);
      });
}

}  // namespace parkade

#include "server/http/file_response.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "server/http/byte_range.h"
#include "server/http/problem.h"
#include "server/http/request_head.h"
#include "server/store/disk/file_sums.h"
#include "server/store/disk/workers_files.h"

namespace parkade {
namespace {

constexpr size_t kUncheckedBytes = 131072;  // per write

/// A file that is read by pieces, each compared with its sum before a byte of it is sent.
class CheckedFile {
 public:
  explicit CheckedFile(ServedFile file)
      : file_(std::move(file)), opened_(OpenWorkersFile(file_.path)) {}

  /// False where it is not there, too short, or the piece at `offset` has changed on the disk.
  bool IsWholeAt(std::int64_t offset) {
    struct stat info {};
    const bool is_there =
        opened_.is_open() && ::fstat(opened_.fd(), &info) == 0 && info.st_size >= file_.bytes;
    const bool is_whole = is_there && (file_.bytes == 0 || !Read(offset).empty());
    if (!is_whole && file_.on_damage) file_.on_damage();
    return is_whole;
  }

  /// Passes some of `length` bytes on. Returns false on errors and when the client is gone.
  bool SendSome(std::int64_t offset, size_t length, httplib::DataSink& sink) {
    const std::string_view content = Read(offset).substr(0, length);
    if (content.empty() && file_.on_damage) file_.on_damage();
    return !content.empty() && sink.write(content.data(), content.size());
  }

 private:
  /// From `offset` to the end of its piece; nothing where that cannot be read or has changed.
  std::string_view Read(std::int64_t offset) {
    const bool is_checked = !file_.pieces.empty();
    const std::int64_t size = is_checked ? kSummedBytes : std::int64_t{kUncheckedBytes};
    const std::int64_t index = offset / size, first = index * size;
    if (index != index_) {
      index_ = -1;
      piece_.resize(static_cast<size_t>(std::min(size, file_.bytes - first)));
      for (size_t got = 0; got < piece_.size();) {
        const ssize_t count = ::pread(opened_.fd(), piece_.data() + got, piece_.size() - got,
                                      first + static_cast<std::int64_t>(got));
        if (count <= 0) return {};
        got += static_cast<size_t>(count);
      }
      if (is_checked && !IsPiece({piece_.data(), piece_.size()}, index, file_.pieces)) return {};
      index_ = index;
    }
    return std::string_view(piece_.data(), piece_.size())
        .substr(static_cast<size_t>(offset - first));
  }

  ServedFile file_;
  const FileHandle opened_;
  std::int64_t index_ = -1;  ///< of the piece that is held
  std::vector<char> piece_;
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

  std::optional<ByteRange> range;
  try {
    range = RangeFor(request, file, etag);
  } catch (const HttpError&) {
    response.set_header("Content-Range", "bytes */" + std::to_string(file.bytes));
    throw;
  }
  const ByteRange part = range.value_or(ByteRange{0, file.bytes});
  const auto checked = std::make_shared<CheckedFile>(file);
  if (!checked->IsWholeAt(part.first))
    throw HttpError(
        {500, "damaged",
         "the stored file '" + file.path.filename().string() + "' is damaged or missing"});
  response.status = range ? 206 : 200;
  if (!etag.empty()) response.set_header("ETag", etag);
  response.set_header("Cache-Control", file.cache_control);
  if (request.method != "HEAD")
    response.set_header("Accept-Ranges", "bytes");  // the library adds it to HEAD
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
      [checked, part](size_t offset, size_t length, httplib::DataSink& sink) {
        return checked->SendSome(part.first + static_cast<std::int64_t>(offset), length, sink);
      });
}

}  // namespace parkade

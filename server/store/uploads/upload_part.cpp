#include "server/store/uploads/upload_part.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

constexpr size_t kMaxParts = 10'000;
constexpr size_t kMaxPartPath = 255;
constexpr std::int64_t kMaxSetBytes = std::int64_t{1} << 60;

/// Relative, of names that lead nowhere else, in printable ASCII.
bool IsPlainPartPath(const std::string& path) {
  if (path.empty() || path.size() > kMaxPartPath) return false;
  const bool is_printable = std::all_of(path.begin(), path.end(),
                                        [](char c) { return c >= ' ' && c <= '~' && c != '\\'; });
  for (size_t begin = 0; begin <= path.size();) {
    const size_t end = std::min(path.find('/', begin), path.size());
    const std::string name = path.substr(begin, end - begin);
    if (name.empty() || name == "." || name == "..") return false;
    begin = end + 1;
  }
  return is_printable;
}

void CheckPart(const UploadPart& part) {
  Require(IsPlainPartPath(part.path), ErrorCode::kInvalidInput,
          "\"path\" of a part is relative, without \"..\", in at most 255 printable characters of "
          "ASCII");
  Require(part.bytes > 0, ErrorCode::kInvalidInput, "the part '" + part.path + "' is empty");
  Require(!part.sha256 || IsSha256(*part.sha256), ErrorCode::kInvalidInput,
          "\"sha256\" of '" + part.path + "' is not 64 hexadecimal digits in lower case");
}

}  // namespace

bool IsSha256(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

void CheckParts(const std::vector<UploadPart>& parts) {
  Require(!parts.empty() && parts.size() <= kMaxParts, ErrorCode::kInvalidInput,
          "an upload set has 1 to 10,000 \"parts\"");
  std::int64_t bytes = 0;
  const std::string* before = nullptr;
  for (const UploadPart& part : parts) {
    CheckPart(part);
    Require(before == nullptr || *before != part.path, ErrorCode::kInvalidInput,
            "the set holds '" + part.path + "' twice");
    before = &part.path;
    Require(part.bytes <= kMaxSetBytes - bytes, ErrorCode::kDiskFull,
            "the disk is full: no disk holds that many bytes");
    bytes += part.bytes;
  }
}

}  // namespace parkade

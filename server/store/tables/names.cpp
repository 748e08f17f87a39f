#include "server/store/tables/names.h"

#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "core/error.h"

namespace parkade {
namespace {

constexpr size_t kMaxNameLength = 64;
constexpr size_t kMaxMadeNameLength = 48;  // leaves room for a suffix
constexpr int kMaxPathDepth = 4;

bool IsLetterOrDigit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool IsPlain(char c) { return IsLetterOrDigit(c) || c == '.' || c == '_' || c == '-'; }

}  // namespace

std::vector<unsigned char> RandomBytes(size_t count) {
  std::vector<unsigned char> bytes(count);
  Require(RAND_bytes(bytes.data(), static_cast<int>(count)) == 1, ErrorCode::kInternal,
          "no random numbers are to be had");
  return bytes;
}

std::string HexOf(const std::vector<unsigned char>& bytes) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kHex[byte >> 4];
    text += kHex[byte & 15];
  }
  return text;
}

std::string UtcText(std::chrono::system_clock::time_point time) {
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count();
  const std::time_t seconds = milliseconds / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 40> text{};
  const size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text.data() + length, text.size() - length, ".%03dZ",
                static_cast<int>(milliseconds % 1000));
  return text.data();
}

bool IsPlainName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxNameLength && IsLetterOrDigit(name.front()) &&
         std::all_of(name.begin(), name.end(), IsPlain);
}

std::string PlainNameFromFilename(std::string_view filename) {
  if (const size_t slash = filename.find_last_of("/\\"); slash != std::string_view::npos)
    filename.remove_prefix(slash + 1);
  for (const std::string_view extension :
       {".tar.gz", ".tar.zst", ".tgz", ".tar", ".zip", ".bag", ".mcap", ".db3", ".zstd"})
    if (filename.size() > extension.size() && filename.ends_with(extension))
      filename.remove_suffix(extension.size());

  std::string name;
  for (const char c : filename.substr(0, kMaxMadeNameLength))
    name += IsPlain(c) && c != '.' ? c : '-';
  name.erase(name.begin(), std::find_if(name.begin(), name.end(), IsLetterOrDigit));
  return name.empty() || name == "tiles" ? "drive" + name
                                         : name;  // a map has a folder tiles/ of its own
}

bool IsPlainPath(std::string_view path) {
  for (int depth = 0; depth < kMaxPathDepth; ++depth) {
    const size_t slash = path.find('/');
    if (!IsPlainName(path.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    path.remove_prefix(slash + 1);
  }
  return false;
}

}  // namespace parkade

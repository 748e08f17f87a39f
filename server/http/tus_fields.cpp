#include "server/http/tus_fields.h"

#include <openssl/evp.h>

#include <array>
#include <charconv>
#include <ctime>

#include "core/error.h"

namespace parkade {
namespace {

constexpr size_t kMaxKeys = 32;

/// Nothing where the text is not base64 of whole groups.
std::optional<std::string> FromBase64(const std::string& text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::string bytes(text.size() / 4 * 3, '\0');
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                   reinterpret_cast<const unsigned char*>(text.data()),
                                   static_cast<int>(text.size()));
  if (size < 0) return std::nullopt;
  const size_t padding = text.size() - (text.find_last_not_of('=') + 1);
  if (padding > 2) return std::nullopt;
  bytes.resize(static_cast<size_t>(size) - padding);
  return bytes;
}

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

[[noreturn]] void Refuse(const std::string& sentence) {
  throw Error(ErrorCode::kInvalidInput, sentence);
}

}  // namespace

std::map<std::string, std::string> ParseTusMetadata(const std::string& field) {
  std::map<std::string, std::string> metadata;
  if (Trimmed(field).empty()) return metadata;
  for (size_t begin = 0; begin <= field.size();) {
    const size_t comma = std::min(field.find(',', begin), field.size());
    const std::string pair = Trimmed(field.substr(begin, comma - begin));
    begin = comma + 1;
    const size_t space = pair.find(' ');
    const std::string key = pair.substr(0, space);
    const std::optional<std::string> value =
        space == std::string::npos ? "" : FromBase64(Trimmed(pair.substr(space)));
    if (key.empty() || !value)
      Refuse("'Upload-Metadata' is a list of keys, each with its value in base64");
    if (!metadata.emplace(key, *value).second)
      Refuse("'Upload-Metadata' holds '" + key + "' twice");
    if (metadata.size() > kMaxKeys) Refuse("'Upload-Metadata' holds more than 32 keys");
  }
  return metadata;
}

PartChecksum ParseTusChecksum(const std::string& field) {
  const size_t space = field.find(' ');
  PartChecksum checksum{field.substr(0, space), ""};
  const std::optional<std::string> digest =
      space == std::string::npos ? std::nullopt : FromBase64(Trimmed(field.substr(space)));
  if (checksum.algorithm != "sha1" && checksum.algorithm != "sha256")
    Refuse("'Upload-Checksum' is by 'sha1' or 'sha256'");
  if (!digest || digest->size() != (checksum.algorithm == "sha1" ? 20 : 32))
    Refuse("'Upload-Checksum' is an algorithm and the hash in base64");
  checksum.digest = *digest;
  return checksum;
}

std::int64_t ParseTusLength(const std::string& name, const std::string& field) {
  std::int64_t length = -1;
  const auto parsed = std::from_chars(field.data(), field.data() + field.size(), length);
  const bool is_number = !field.empty() && parsed.ec == std::errc{} &&
                         parsed.ptr == field.data() + field.size() && length >= 0;
  if (!is_number) Refuse("'" + name + "' is a number of bytes");
  return length;
}

std::string HttpDate(const std::string& utc) {
  std::tm time{};
  ::strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%S", &time);
  ::timegm(&time);  // finds the day of the week
  std::array<char, 40> text{};
  std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &time);
  return text.data();
}

}  // namespace parkade

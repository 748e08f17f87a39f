#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace parkade {

/// From the kernel's random numbers. Throws Error{kInternal} where there are none.
std::vector<unsigned char> RandomBytes(size_t count);

/// Two hexadecimal digits for each byte.
std::string HexOf(const std::vector<unsigned char>& bytes);

/// 16 hexadecimal digits of random numbers.
inline std::string NewId() { return HexOf(RandomBytes(8)); }

/// A time as RFC 3339 in UTC with milliseconds, "2026-11-21T04:22:27.123Z": texts order as times
/// do.
std::string UtcText(std::chrono::system_clock::time_point time);
/// The time in `delay`.
inline std::string UtcIn(std::chrono::milliseconds delay) {
  return UtcText(std::chrono::system_clock::now() + delay);
}
inline std::string NowUtc() { return UtcIn(std::chrono::milliseconds{0}); }

/// True for names of sites, rigs and mask files: 1 to 64 characters of
/// [A-Za-z0-9._-], the first a letter or digit.
bool IsPlainName(std::string_view name);

/// A plain name without dots made of what a user calls a file, at most 48 long:
/// the extension is dropped, what is not allowed becomes '-', "drive" where
/// nothing is left.
std::string PlainNameFromFilename(std::string_view filename);

/// True for a relative path of plain names ("tiles/0.glb"), at most 4 deep.
bool IsPlainPath(std::string_view path);

}  // namespace parkade

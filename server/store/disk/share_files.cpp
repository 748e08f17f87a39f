#include "server/store/disk/share_files.h"

#include <cstdint>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/files/sha256.h"
#include "core/log.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMinBytes = 64 << 10;  // smaller ones are not worth it

bool IsWorthIt(const fs::path& older, const fs::path& file) {
  std::error_code missing;
  const std::uintmax_t bytes = fs::file_size(file, missing);
  return !missing && bytes >= kMinBytes && fs::file_size(older, missing) == bytes && !missing &&
         !fs::equivalent(older, file, missing) && !missing;
}

void Share(const fs::path& older, const fs::path& file) {
  fs::path next = file;
  next += ".next";
  std::error_code failed;
  fs::create_hard_link(older, next, failed);
  if (!failed) fs::rename(next, file, failed);
  if (failed) fs::remove(next, failed);
}

}  // namespace

void ShareFilesWith(const fs::path& older, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (fs::is_regular_file(entry.symlink_status())) files.push_back(entry.path());
  for (const fs::path& file : files) {
    const fs::path counterpart = older / file.lexically_relative(folder);
    try {
      // By content, since the older file may have rotted meanwhile.
      if (IsWorthIt(counterpart, file) && Sha256OfFile(counterpart) == Sha256OfFile(file))
        Share(counterpart, file);
    } catch (const Error& error) {
      LogWarning(std::string("file not shared error=") + error.what());
    }
  }
}

}  // namespace parkade

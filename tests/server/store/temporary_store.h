#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "core/files/sha256.h"
#include "server/store/receive_upload.h"
#include "server/store/store.h"
#include "server/store/temporary_path.h"
#include "tests/server/store/temporary_root.h"

namespace parkade {

inline void WriteText(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

/// Everything below a folder, as relative paths; folders end with '/'. Read again where something
/// goes meanwhile, as when a job that has ended is tidied up.
inline std::set<std::string> ContentOf(const std::filesystem::path& folder) {
  constexpr int kTries = 100;
  for (int i = 1;; ++i) {
    try {
      std::set<std::string> names;
      for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        names.insert(entry.path().lexically_relative(folder).string() +
                     (entry.is_directory() ? "/" : ""));
      return names;
    } catch (const std::filesystem::filesystem_error&) {
      if (i == kTries) throw;
    }
  }
}

/// Takes in `content` as an upload would.
inline ReceivedDrive Receive(Store& store, const std::string& content, const NewDrive& drive,
                             bool merge_drives = false) {
  const TemporaryPath path(store.directory.NewTemporaryPath());
  WriteText(path.get(), content);
  return ReceiveDrive(store, drive,
                      {path.get(), static_cast<std::int64_t>(content.size()), Sha256Of(content)},
                      merge_drives);
}

/// A store in a folder of its own.
class StoreTest : public testing::Test {
 protected:
  TemporaryRoot root_;
  Store store_{root_.path() / "data"};
};

}  // namespace parkade

#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "server/store/tables/drive_table.h"
#include "server/store/uploads/resumable_uploads.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {

/// A store that takes uploads: logs begin with "log", and archives hold paths that end with ".bag".
class UploadTest : public StoreTest {
 protected:
  void SetUp() override { Open(); }

  /// As a service does when it starts.
  void Open(std::chrono::hours lifetime = std::chrono::hours(24)) {
    uploads_.reset();
    UploadOptions options;
    options.check_log = [](const std::filesystem::path& file, const std::string& name) {
      Require(ReadFile(file).starts_with("log"), ErrorCode::kInvalidInput, name + " is no log");
    };
    options.check_paths = [](const std::vector<std::string>& paths) {
      for (const std::string& path : paths)
        Require(path.ends_with(".bag"), ErrorCode::kInvalidInput, path + " is no bag");
    };
    options.on_received = [this](const ReceivedDrive&) { ++received_; };
    options.lifetime = lifetime;
    uploads_.emplace(store_, options);
  }

  /// Adds `text` to the upload of this id.
  Upload Append(const std::string& id, std::int64_t offset, const std::string& text,
                const std::optional<PartChecksum>& checksum = std::nullopt) {
    return uploads_->Append(
        id, offset, std::ssize(text),
        [&](const auto& take) {
          take(text);
          return true;
        },
        checksum, [] {});
  }

  size_t NumDrives() {
    return store_.database
        .Read([](Connection& connection) { return ListDrives(connection, {}, std::nullopt); })
        .size();
  }

  std::optional<ResumableUploads> uploads_;
  std::atomic<int> received_ = 0;
};

}  // namespace parkade

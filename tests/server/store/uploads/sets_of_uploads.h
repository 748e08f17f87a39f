#pragma once

#include <archive.h>
#include <archive_entry.h>

#include <map>
#include <thread>

#include "tests/server/store/uploads/upload_test.h"

namespace parkade {

/// The files of a tar, by their paths.
inline std::map<std::string, std::string> FilesOfTar(const std::filesystem::path& file) {
  archive* reader = archive_read_new();
  archive_read_support_format_tar(reader);
  EXPECT_EQ(archive_read_open_filename(reader, file.c_str(), 10240), ARCHIVE_OK);
  std::map<std::string, std::string> files;
  archive_entry* entry = nullptr;
  int status;
  while ((status = archive_read_next_header(reader, &entry)) == ARCHIVE_OK) {
    std::string content(static_cast<size_t>(archive_entry_size(entry)), '\0');
    EXPECT_EQ(archive_read_data(reader, content.data(), content.size()), std::ssize(content));
    EXPECT_EQ(archive_entry_mtime(entry), 0);
    files[archive_entry_pathname(entry)] = content;
  }
  EXPECT_EQ(status, ARCHIVE_EOF) << archive_error_string(reader);
  archive_read_free(reader);
  return files;
}

/// A store that takes sets of uploads.
class SetsOfUploads : public UploadTest {
 protected:
  UploadSets& sets() { return uploads_->sets(); }

  UploadSets::SetWithParts Declare(std::vector<UploadPart> parts) {
    UploadSet set;
    set.filename = "tour";
    set.site = "lot";
    return sets().Create(set, std::move(parts));
  }
  /// A set of "b.bag" and "a.bag", with these contents.
  UploadSets::SetWithParts DeclareTwo(const std::string& b, const std::string& a) {
    return Declare(
        {{"tour/b.bag", std::ssize(b), Sha256Of(b)}, {"tour/a.bag", std::ssize(a), std::nullopt}});
  }
  UploadSet WaitForEnd(const std::string& id) {
    UploadSet set;
    for (int i = 0; i < 1000; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
      set = sets().Look(id).set;
      if (set.state == UploadSetState::kDone || set.state == UploadSetState::kRefused) break;
    }
    return set;
  }
  /// What is done after the row of a set says that it has ended.
  template <typename Probe>
  static bool Soon(const Probe& probe) {
    for (int i = 0; i < 1000 && !probe(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return probe();
  }
  bool HasNoFile() const { return std::filesystem::is_empty(store_.directory.UploadsFolder()); }
  Drive DriveOf(const UploadSet& set) {
    return store_.database.Read(
        [&](Connection& connection) { return FindDrive(connection, set.drive.value_or("")); });
  }
  std::map<std::string, std::string> LogOf(const UploadSet& set) {
    return FilesOfTar(store_.directory.LogFile(DriveOf(set).sha256));
  }
  size_t NumLogs() {
    size_t count = 0;
    for (const std::string& name : ContentOf(store_.directory.LogsFolder()))
      count += name.ends_with('/') ? 0 : 1;
    return count;
  }
};

}  // namespace parkade

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace parkade {

/// Tells, path by path, which files of an archive are those of its drive: either an EuRoC drive
/// (its mav0, at most three folders deep), the log files of one folder, with the metadata.yaml
/// beside them, or else a drive as FolderLayout has them, of which each folder gets a number.
/// Safe against any archive: what it returns is built from the parts that such a folder has
/// (`cam0/data/<plain name>`, ...) and from plain names with the extensions of logs (.bag, .mcap,
/// .db3, each perhaps with .zstd, and .db3-wal).
class ArchivePaths {
 public:
  /// `name`: that of the archive, for sentences; log files get a folder of that name.
  explicit ArchivePaths(std::string name) : name_(std::move(name)) {}

  /// Throws Error{kInvalidInput} for a path that leads outside.
  void RequireInside(std::string_view path) const;

  /// Where the file at `path` is to lie; nothing for files that are passed over. Throws as
  /// RequireInside does, and for a log file that has no plain name, a second drive and log files
  /// in a second folder.
  std::optional<std::filesystem::path> PlaceOf(std::string_view path);

  /// Whether a file of a drive was among them.
  bool has_drive() const { return kind_.has_value() || has_other_drive_; }
  bool are_log_files() const { return kind_ == Kind::kLogFiles; }
  /// Whether the metadata.yaml that PlaceOf found is not of the folder of the log files.
  bool is_metadata_foreign() const { return metadata_root_ && metadata_root_ != root_; }

  /// "drive.zip holds no drive: ..."
  std::string SentenceWithoutDrive() const;

 private:
  enum class Kind { kEuroc, kLogFiles };

  std::optional<std::filesystem::path> PlaceOfLogFile(const std::vector<std::string>& parts);
  std::optional<std::filesystem::path> PlaceOfOtherFile(const std::vector<std::string>& parts);
  void Note(Kind kind, const std::string& root);

  std::string name_;
  std::optional<Kind> kind_;
  std::string root_;  ///< the folders above the drive, "" or "drive/mav0/"
  std::optional<std::string> metadata_root_;
  std::vector<std::string> other_roots_;  ///< of folders that may be drives of other layouts
  bool has_other_drive_ = false;
};

/// Throws Error{kInvalidInput} with one sentence unless an archive of files with these paths holds
/// one drive. `name` is what the sentence calls it.
void CheckHoldsDrive(const std::vector<std::string>& paths, const std::string& name);

}  // namespace parkade

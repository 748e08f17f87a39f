#include "server/ingest/files/archive_extraction.h"

#include <archive.h>
#include <archive_entry.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include "core/error.h"
#include "server/ingest/files/archive_paths.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxRatio = 8, kFreeBytes = std::uint64_t{64} << 20;
constexpr std::uint64_t kMaxFiles = 1'000'000;

struct ArchiveDeleter {
  void operator()(archive* reader) const { archive_read_free(reader); }
};
using ArchiveReader = std::unique_ptr<archive, ArchiveDeleter>;

ArchiveReader OpenArchive(const fs::path& file) {
  constexpr std::size_t kBlockSize = 1 << 18;
  ArchiveReader reader(archive_read_new());
  archive_read_support_format_tar(reader.get());
  archive_read_support_format_zip(reader.get());
  archive_read_support_filter_gzip(reader.get());
  archive_read_support_filter_zstd(reader.get());
  Require(archive_read_open_filename(reader.get(), file.c_str(), kBlockSize) == ARCHIVE_OK,
          ErrorCode::kInvalidInput,
          file.filename().string() + " is not an archive that can be read");
  return reader;
}

/// A zstd file may hold anything, for example a rosbag2 database.
bool HoldsTar(const fs::path& file) {
  archive_entry* entry = nullptr;
  const int status = archive_read_next_header(OpenArchive(file).get(), &entry);
  return status == ARCHIVE_OK || status == ARCHIVE_WARN;
}

class Extractor {
 public:
  Extractor(const fs::path& archive, const fs::path& target)
      : name_(archive.filename().string()),
        target_(target),
        paths_(name_),
        max_bytes_(kMaxRatio * fs::file_size(archive) + kFreeBytes),
        reader_(OpenArchive(archive)) {}

  ExtractionResult Run() {
    ExtractionResult result;
    archive_entry* entry = nullptr;
    int status;
    while ((status = archive_read_next_header(reader_.get(), &entry)) == ARCHIVE_OK ||
           status == ARCHIVE_WARN) {
      if (!Extract(entry, result)) break;
      // Empty entries cost an entry of the folder each, and must not be endless either.
      Require(++num_entries_ <= kMaxFiles, ErrorCode::kInvalidInput,
              name_ + " holds more than a million entries");
    }
    if (status != ARCHIVE_EOF && result.damage.empty()) result.damage = ErrorText();
    Require(paths_.has_drive(), ErrorCode::kInvalidInput,
            result.damage.empty() ? paths_.SentenceWithoutDrive()
                                  : name_ + " cannot be read: " + result.damage);
    if (!paths_.are_log_files()) return result;
    result.log_folder = target_ / name_;
    if (paths_.is_metadata_foreign()) fs::remove(*result.log_folder / "metadata.yaml");
    return result;
  }

 private:
  /// Reads the next entry. False when the archive is damaged from here on.
  bool Extract(archive_entry* entry, ExtractionResult& result) {
    const char* raw_path = archive_entry_pathname(entry);
    const std::string path = raw_path ? raw_path : "";
    paths_.RequireInside(path);
    // A hard link has the type of a regular file, and no content.
    if (archive_entry_filetype(entry) != AE_IFREG || archive_entry_hardlink(entry)) return true;
    const std::optional<fs::path> place = paths_.PlaceOf(path);
    return !place || WriteContent(*place, result);
  }

  /// Makes the folders of a file, below a target that must be there: one that a signal has removed
  /// stays so.
  void MakeFoldersOf(const fs::path& relative) {
    if (relative.parent_path() == last_folder_) return;
    last_folder_ = relative.parent_path();
    fs::path folder = target_;
    for (const fs::path& part : last_folder_) fs::create_directory(folder /= part);
  }

  bool WriteContent(const fs::path& relative, ExtractionResult& result) {
    MakeFoldersOf(relative);
    const fs::path file = target_ / relative;
    errno = 0;
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    while (true) {
      const la_ssize_t size = archive_read_data(reader_.get(), buffer_.data(), buffer_.size());
      if (size < 0) result.damage = ErrorText();
      if (size <= 0) break;
      num_bytes_ += static_cast<std::uint64_t>(size);
      Require(num_bytes_ <= max_bytes_, ErrorCode::kInvalidInput,
              name_ + " unpacks to more than 8 times its size: refused");
      stream.write(buffer_.data(), size);
      if (!stream) break;
    }
    stream.close();
    Require(stream.good(),
            errno == ENOSPC || errno == EDQUOT ? ErrorCode::kDiskFull : ErrorCode::kInternal,
            "cannot unpack " + name_ + ": " + std::strerror(errno));
    return result.damage.empty();
  }

  std::string ErrorText() const {
    const char* text = archive_error_string(reader_.get());
    return text ? text : "damaged archive";
  }

  std::string name_;
  fs::path target_, last_folder_;
  ArchivePaths paths_;
  std::uint64_t max_bytes_;
  ArchiveReader reader_;
  std::uint64_t num_bytes_ = 0, num_entries_ = 0;
  std::vector<char> buffer_ = std::vector<char>(1 << 18);
};

}  // namespace

bool IsArchive(const fs::path& file) {
  std::array<char, 512> head{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), head.size());
  const std::string_view start(head.data(), static_cast<std::size_t>(stream.gcount()));
  constexpr std::size_t kTarMagicOffset = 257;
  if (start.starts_with("\x28\xb5\x2f\xfd")) return HoldsTar(file);
  return start.starts_with("PK\x03\x04") || start.starts_with("\x1f\x8b") ||
         (start.size() > kTarMagicOffset && start.substr(kTarMagicOffset).starts_with("ustar"));
}

ExtractionResult ExtractArchive(const fs::path& archive, const fs::path& target) {
  return Extractor(archive, target).Run();
}

}  // namespace parkade

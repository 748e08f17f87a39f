#include "server/ingest/files/archive_extraction.h"

#include <archive.h>
#include <archive_entry.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxRatio = 8, kFreeBytes = std::uint64_t{64} << 20;
constexpr std::uint64_t kMaxFiles = 1'000'000;
constexpr std::size_t kMaxPathLength = 1024, kMaxNameLength = 128, kMaxDepth = 3;

std::vector<std::string> SplitPath(std::string_view path) {
  std::vector<std::string> parts;
  while (!path.empty()) {
    const std::size_t slash = path.find('/');
    const std::string_view part = path.substr(0, slash);
    if (!part.empty() && part != ".") parts.emplace_back(part);
    path = slash == std::string_view::npos ? std::string_view{} : path.substr(slash + 1);
  }
  return parts;
}

bool IsPlainName(const std::string& name) {
  if (name.empty() || name.size() > kMaxNameLength || name.front() == '.') return false;
  return std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c < 128 && (std::isalnum(c) || c == '.' || c == '_' || c == '-');
  });
}

bool IsCameraName(const std::string& name) {
  return name.size() >= 4 && name.size() <= 6 && name.starts_with("cam") &&
         std::all_of(name.begin() + 3, name.end(), [](unsigned char c) { return std::isdigit(c); });
}

/// The part of an entry's path inside the EuRoC folder.
struct EurocPath {
  std::string root;  ///< the folders above, "" or "drive/mav0"
  fs::path relative;
};

/// Splits a path; nothing for files that are no part of an EuRoC drive.
std::optional<EurocPath> ParseEurocPath(const std::vector<std::string>& parts) {
  std::string root;
  for (std::size_t i = 0; i + 1 < parts.size() && i <= kMaxDepth; root += parts[i] + "/", ++i) {
    const std::string& sensor = parts[i];
    const bool is_camera = IsCameraName(sensor);
    if (!is_camera && sensor != "imu0" && sensor != "odom0" && sensor != "gnss0") continue;
    std::vector<std::string> rest(parts.begin() + static_cast<std::ptrdiff_t>(i) + 1, parts.end());
    fs::path relative = sensor;
    if (is_camera && rest.front() == "semantic" && rest.size() > 1) {
      relative /= "semantic";
      rest.erase(rest.begin());
    }
    if (rest.size() == 1 && (rest[0] == "data.csv" || rest[0] == "sensor.yaml"))
      return EurocPath{root, relative / rest[0]};
    if (is_camera && rest.size() == 2 && rest[0] == "data" && IsPlainName(rest[1]))
      return EurocPath{root, relative / "data" / rest[1]};
  }
  return std::nullopt;
}

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
    Require(result.num_files > 0, ErrorCode::kInvalidInput,
            name_ + (result.damage.empty() ? " holds no EuRoC drive (mav0 with imu0, cam0, ...)"
                                           : " cannot be read: " + result.damage));
    return result;
  }

 private:
  /// Reads the next entry. False when the archive is damaged from here on.
  bool Extract(archive_entry* entry, ExtractionResult& result) {
    const char* raw_path = archive_entry_pathname(entry);
    const std::string path = raw_path ? raw_path : "";
    if (path.empty() || path.size() > kMaxPathLength) return true;
    const std::vector<std::string> parts = SplitPath(path);
    const bool leads_outside =
        path.front() == '/' || std::find(parts.begin(), parts.end(), "..") != parts.end();
    Require(!leads_outside, ErrorCode::kInvalidInput,
            name_ + " holds an entry that leads outside of it");
    // A hard link has the type of a regular file, and no content.
    if (archive_entry_filetype(entry) != AE_IFREG || archive_entry_hardlink(entry)) return true;
    const std::optional<EurocPath> euroc = ParseEurocPath(parts);
    if (!euroc) return true;
    if (result.num_files == 0) root_ = euroc->root;
    Require(euroc->root == root_, ErrorCode::kInvalidInput,
            name_ + " holds several EuRoC drives: give one of them");
    ++result.num_files;
    return WriteContent(euroc->relative, result);
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
  std::uint64_t max_bytes_;
  ArchiveReader reader_;
  std::string root_;
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

ExtractionResult ExtractEurocArchive(const fs::path& archive, const fs::path& target) {
  return Extractor(archive, target).Run();
}

}  // namespace parkade

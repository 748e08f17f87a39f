#include "server/ingest/containers/open_message_source.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/files/file.h"
#include "server/ingest/containers/chunked_log_source.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/joined_source.h"
#include "server/ingest/containers/kept_source.h"
#include "server/ingest/containers/record_walker.h"
#include "server/ingest/containers/rosbag2_sqlite_source.h"
#include "server/ingest/containers/zstd_file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoLog = "neither a ROS 1 bag, nor MCAP, nor rosbag2";

enum class LogKind { kNone, kOldBag, kBag, kMcap, kSqlite, kZstd };

/// Recognizes a file by its first bytes.
LogKind KindOf(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("#ROSBAG V2.0\n"sv)) return LogKind::kBag;
  if (bytes.starts_with("#ROSBAG V1."sv)) return LogKind::kOldBag;
  if (bytes.starts_with("\x89MCAP0\r\n"sv)) return LogKind::kMcap;
  if (bytes.starts_with("SQLite format 3\0"sv)) return LogKind::kSqlite;
  if (bytes.starts_with("\x28\xB5\x2F\xFD"sv)) return LogKind::kZstd;
  return LogKind::kNone;
}

LogKind KindOf(const InputFile& file) {
  std::array<std::uint8_t, 16> bytes{};
  const std::size_t size = file.ReadAt(0, bytes);
  return KindOf(std::string_view(reinterpret_cast<const char*>(bytes.data()), size));
}

/// True when the first megabytes hold a record that nothing else looks like.
bool HasRecords(const InputFile& file, const LogFormat& format) {
  constexpr std::uint64_t kSearched = std::uint64_t{16} << 20;
  FileReader reader(file, kSearched);
  RecordWalker walker(format, reader);
  for (std::uint64_t offset = 0; offset < reader.size();) {
    const RecordWalker::Step step = walker.At(offset);
    const bool is_record = !step.is_damaged && step.record->is_exact;
    if (is_record && step.record->kind != RecordKind::kOther) return true;
    offset = step.next;
  }
  return false;
}

/// Recognizes a file whose first bytes are damaged.
LogKind KindOfDamaged(const InputFile& file) {
  if (HasRecords(file, Rosbag1Format())) return LogKind::kBag;
  if (HasRecords(file, McapFormat())) return LogKind::kMcap;
  return LogKind::kNone;
}

std::unique_ptr<MessageSource> OpenAs(LogKind kind, const fs::path& path,
                                      const fs::path& scratch_folder) {
  const std::string name = "'" + path.filename().string() + "'";
  const auto file = std::make_shared<const InputFile>(path);
  switch (kind) {
    case LogKind::kBag: return OpenChunkedLog(file, Rosbag1Format());
    case LogKind::kMcap: return OpenChunkedLog(file, McapFormat());
    case LogKind::kSqlite: return OpenRosbag2Sqlite(path, scratch_folder);
    case LogKind::kOldBag:
      throw Error(ErrorCode::kInvalidInput,
                  name + " is a ROS bag of format 1, which rosbag fix turns into format 2");
    case LogKind::kZstd: {
      UnpackedFile unpacked =
          UnpackZstdFile(*file, scratch_folder, [](std::string_view first_bytes) {
            const LogKind inner = KindOf(first_bytes);
            return inner != LogKind::kNone && inner != LogKind::kZstd;
          });
      if (!unpacked.file) break;
      const LogKind inner = KindOf(InputFile(unpacked.file->path()));
      return KeepUnpacked(OpenAs(inner, unpacked.file->path(), scratch_folder), unpacked.file,
                          unpacked.damage);
    }
    case LogKind::kNone: break;
  }
  throw Error(ErrorCode::kInvalidInput, name + " is not a drive log: " + kNoLog);
}

/// "'a', 'b' and 3 others".
std::string Quote(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxNames = 3;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNames); ++i)
    list.append(i == 0 ? "'" : i + 1 < names.size() ? ", '" : " and '").append(names[i] + "'");
  if (names.size() <= kMaxNames) return list;
  return list + " and " + std::to_string(names.size() - kMaxNames) + " others";
}

/// By the files, which the user knows: a set of files that was uploaded lies in a folder of ours.
[[noreturn]] void ThrowNoLog(const fs::path& folder, const std::vector<std::string>& names) {
  const std::string what = names.empty() ? "'" + folder.filename().string() + "' holds no drive log"
                           : names.size() == 1
                               ? Quote(names) + " is not a drive log: " + kNoLog
                               : "none of the files " + Quote(names) + " is a drive log: " + kNoLog;
  throw Error(ErrorCode::kInvalidInput, what);
}

/// The files that metadata.yaml names, without their folders; empty where there is none that can be
/// read.
std::vector<std::string> FilesInMetadata(const fs::path& folder) {
  std::vector<std::string> names;
  try {
    const YAML::Node root = YAML::Load(ReadFile(folder / "metadata.yaml", std::size_t{16} << 20));
    for (const YAML::Node& path : root["rosbag2_bagfile_information"]["relative_file_paths"])
      names.push_back(fs::path(path.as<std::string>()).filename().string());
  } catch (const YAML::Exception&) {
    names.clear();
  } catch (const Error&) {  // there is no such file
  }
  return names;
}

std::unique_ptr<MessageSource> OpenFolder(const fs::path& folder, const fs::path& scratch_folder) {
  std::vector<std::string> names;
  DamageReport missing;
  for (const std::string& name : FilesInMetadata(folder)) {
    // A file that was packed or unpacked since has the same name with or without its last part.
    const std::array<std::string, 3> candidates = {name, name + ".zstd",
                                                   fs::path(name).stem().string()};
    const auto found =
        std::find_if(candidates.begin(), candidates.end(),
                     [&](const std::string& candidate) { return IsFile(folder / candidate); });
    if (found != candidates.end()) {
      names.push_back(*found);
    } else {
      AddLoss(missing, {"the file '" + name + "' that metadata.yaml names is missing", "", {}, 0});
    }
  }
  const bool are_named = !names.empty();
  if (!are_named) {
    missing = {};
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
    // "drive_2" before "drive_10"
    std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
      return strverscmp(a.c_str(), b.c_str()) < 0;
    });
  }
  std::vector<std::unique_ptr<MessageSource>> parts;
  std::set<std::string> formats;
  for (const std::string& name : names) {
    LogKind kind = KindOf(InputFile(folder / name));
    if (kind == LogKind::kNone && are_named) kind = KindOfDamaged(InputFile(folder / name));
    if (kind == LogKind::kNone) {
      if (are_named)
        AddLoss(missing,
                {"the file '" + name + "' that metadata.yaml names holds nothing", "", {}, 0});
      continue;
    }
    parts.push_back(OpenAs(kind, folder / name, scratch_folder));
    formats.insert(parts.back()->format());
  }
  if (parts.empty()) ThrowNoLog(folder, names);
  Require(formats.size() == 1, ErrorCode::kInvalidInput,
          "the files " + Quote(names) + " are logs of several formats (" + *formats.begin() + ", " +
              *formats.rbegin() + "): choose one of them");
  return JoinSources(std::move(parts), missing);
}

}  // namespace

std::unique_ptr<MessageSource> OpenMessageSource(const fs::path& log,
                                                 const fs::path& scratch_folder) {
  if (fs::is_directory(log)) return OpenFolder(log, scratch_folder);
  LogKind kind = LogKind::kNone;
  {
    const InputFile file(log);
    kind = KindOf(file);
    if (kind == LogKind::kNone) kind = KindOfDamaged(file);
  }
  return OpenAs(kind, log, scratch_folder);
}

}  // namespace parkade

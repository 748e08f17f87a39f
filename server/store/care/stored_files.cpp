#include "server/store/care/stored_files.h"

#include <fstream>

#include "core/files/file.h"
#include "core/files/sha256.h"
#include "core/log.h"
#include "server/store/rig_store.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/drive_table.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr size_t kPieceBytes = size_t{1} << 20;
const std::string kLogs = "logs/", kMaps = "maps/";
const std::string kMissing = "is missing", kChanged = "has changed on the disk",
                  kUnreadable = "cannot be read";

std::optional<std::string> CheckRig(const std::filesystem::path& data, const StoredFile& file) {
  RigFiles files;
  for (const fs::directory_entry& entry : fs::directory_iterator(data / file.path))
    files[entry.path().filename().string()] = ReadFile(entry.path());
  return Sha256Of(PackRig(files)) == file.sha256 ? std::nullopt : std::optional(kChanged);
}

}  // namespace

std::vector<StoredFile> StoredFiles(Connection& connection) {
  std::vector<StoredFile> files;
  Statement logs = connection.Query(
      "SELECT sha256, max(bytes) FROM drives WHERE deleted_at IS NULL AND log_deleted_at IS NULL "
      "GROUP BY sha256");
  while (logs.Step())
    files.push_back({DataDirectory::LogPath(logs.Text(0)), logs.Integer(1), logs.Text(0)});
  Statement maps = connection.Query("SELECT map, name, bytes, sha256 FROM map_files");
  while (maps.Step())
    files.push_back({kMaps + maps.Text(0) + "/" + maps.Text(1), maps.Integer(2), maps.Text(3)});
  Statement rigs = connection.Query("SELECT id, sha256 FROM rigs");
  while (rigs.Step()) files.push_back({"rigs/" + rigs.Text(0), 0, rigs.Text(1), rigs.Text(0)});
  return files;
}

bool IsStored(Connection& connection, const std::string& path) {
  if (path.starts_with(kLogs))
    return CountDrivesWithContent(connection, path.substr(path.rfind('/') + 1)) > 0;
  if (!path.starts_with(kMaps)) return true;  // rigs stay
  const size_t slash = path.find('/', kMaps.size());
  return connection
      .Query("SELECT 1 FROM map_files WHERE map = ? AND name = ?",
             path.substr(kMaps.size(), slash - kMaps.size()), path.substr(slash + 1))
      .Step();
}

std::optional<std::string> LookAtStoredFile(const std::filesystem::path& data,
                                            const StoredFile& file) {
  const fs::path path = data / file.path;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return kMissing;
  if (!file.rig.empty()) return fs::is_directory(status) ? std::nullopt : std::optional(kMissing);
  const auto bytes = fs::file_size(path, error);
  if (error || !fs::is_regular_file(status)) return kUnreadable;
  if (static_cast<std::int64_t>(bytes) == file.bytes) return std::nullopt;
  return "has " + std::to_string(bytes) + " bytes instead of " + std::to_string(file.bytes);
}

std::optional<std::string> CheckStoredFile(const std::filesystem::path& data,
                                           const StoredFile& file,
                                           const std::function<bool()>& go_on) {
  if (auto damage = LookAtStoredFile(data, file)) return damage;
  if (!file.rig.empty()) return CheckRig(data, file);
  std::ifstream stream(data / file.path, std::ios::binary);
  std::vector<char> piece(kPieceBytes);
  Sha256 hash;
  while (stream.read(piece.data(), kPieceBytes) || stream.gcount() > 0) {
    if (!go_on()) return std::nullopt;
    hash.Add({piece.data(), static_cast<size_t>(stream.gcount())});
  }
  if (!stream.eof()) return kUnreadable;
  return hash.Finish() == file.sha256 ? std::nullopt : std::optional(kChanged);
}

void RecordFileCheck(Store& store, const std::string& path,
                     const std::optional<std::string>& damage) {
  const bool is_stored = store.database.Write([&](Connection& connection) {
    if (!IsStored(connection, path)) return false;
    SetFileCheck(connection, path, damage);
    return true;
  });
  if (is_stored && damage) LogError("damaged file path=" + path + " damage=" + *damage);
}

}  // namespace parkade

#include "server/store/rig_store.h"

#include "core/calibration/rig_files.h"
#include "core/error.h"
#include "core/files/file.h"
#include "core/files/sha256.h"
#include "server/store/access/audit_log.h"
#include "server/store/disk/durable_file.h"
#include "server/store/tables/names.h"
#include "server/store/tables/rig_table.h"
#include "server/store/temporary_path.h"

namespace parkade {

namespace fs = std::filesystem;

namespace {

void Rename(RigFiles& files, const std::string& from, const std::string& to) {
  if (from.empty() || from == to) return;
  auto file = files.extract(from);
  file.key() = to;
  files.insert(std::move(file));
}

/// The files by their usual names, where they have those that Kalibr gave them.
RigFiles WithUsualNames(RigFiles files) {
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const auto& [name, content] : files) names.push_back(name);
  const RigFileNames found = FindRigFiles(names);
  Rename(files, found.camera_chain, kCameraChainFile);
  Rename(files, found.imu, kImuFile);
  Rename(files, found.basalt, kBasaltFile);
  return files;
}

}  // namespace

StoredRig StoreRig(Store& store, const std::string& name, RigFiles files,
                   const std::function<void(const fs::path&)>& check_rig) {
  Require(IsPlainName(name), ErrorCode::kInvalidInput,
          "the name of a rig is 1 to 64 letters, digits, dots, dashes or underscores, and starts "
          "with a letter or digit");
  files = WithUsualNames(std::move(files));
  const bool is_basalt = files.contains(kBasaltFile) && !files.contains(kCameraChainFile);
  for (const char* required : {kCameraChainFile, kImuFile, "vehicle.yaml"})
    Require(files.contains(required) || (is_basalt && std::string_view(required) != "vehicle.yaml"),
            ErrorCode::kInvalidInput, std::string("the rig lacks '") + required + "'");
  for (const auto& [file, content] : files)
    Require(IsPlainName(file), ErrorCode::kInvalidInput,
            "the rig holds a file with an unusual name");

  const TemporaryPath folder(store.directory.NewTemporaryPath());
  fs::create_directory(folder.get());
  for (const auto& [file, content] : files) WriteFileAtomically(folder.get() / file, content);
  if (check_rig) check_rig(folder.get());

  StoredRig rig;
  rig.id = NewId();
  rig.name = name;
  rig.sha256 = Sha256Of(PackRig(files));
  for (const auto& [file, content] : files) rig.files.push_back(file);
  rig.created_at = NowUtc();
  fs::rename(folder.get(), store.directory.RigFolder(rig.id));
  SyncToDisk(store.directory.RigsFolder());
  store.database.Write([&](Connection& connection) {
    InsertRig(connection, rig);
    RecordAudit(connection, "rig.put", rig.name, "{\"sha256\":\"" + rig.sha256 + "\"}");
  });
  return rig;
}

std::string ReadRigArchive(const Store& store, const StoredRig& rig) {
  RigFiles files;
  for (const std::string& file : rig.files)
    files[file] = ReadFile(store.directory.RigFolder(rig.id) / file);
  std::string zip = PackRig(files);
  Require(Sha256Of(zip) == rig.sha256, ErrorCode::kInternal,
          "the stored rig '" + rig.name + "' has changed on the disk: upload it again");
  return zip;
}

}  // namespace parkade

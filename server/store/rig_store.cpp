#include "server/store/rig_store.h"

#include "core/error.h"
#include "core/file.h"
#include "server/store/durable_file.h"
#include "server/store/names.h"
#include "server/store/rig_table.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// A folder that is gone at the end unless it was moved away.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) { fs::create_directory(path_); }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

StoredRig StoreRig(Store& store, const std::string& name, const RigFiles& files,
                   const std::function<void(const fs::path&)>& check_rig) {
  Require(
      IsPlainName(name), ErrorCode::kInvalidInput,
      "the name of a rig is 1 to 64 letters, digits, dots, dashes or underscores, and starts with a letter or digit");
  for (const char* required : {"camchain-imucam.yaml", "imu0.yaml", "vehicle.yaml"})
    Require(files.contains(required), ErrorCode::kInvalidInput, std::string("the rig lacks '") + required + "'");
  for (const auto& [file, content] : files)
    Require(IsPlainName(file), ErrorCode::kInvalidInput, "the rig holds a file with an unusual name");

  const TemporaryFolder folder(store.directory.NewTemporaryPath());
  for (const auto& [file, content] : files) WriteFileAtomically(folder.path() / file, content);
  if (check_rig) check_rig(folder.path());

  StoredRig rig;
  rig.id = NewId();
  rig.name = name;
  rig.sha256 = Sha256Of(PackRig(files));
  for (const auto& [file, content] : files) rig.files.push_back(file);
  rig.created_at = NowUtc();
  fs::rename(folder.path(), store.directory.RigFolder(rig.id));
  SyncToDisk(store.directory.RigsFolder());
  store.database.Write([&](Connection& connection) { InsertRig(connection, rig); });
  return rig;
}

std::string ReadRigArchive(const Store& store, const StoredRig& rig) {
  RigFiles files;
  for (const std::string& file : rig.files) files[file] = ReadFile(store.directory.RigFolder(rig.id) / file);
  return PackRig(files);
}

}  // namespace parkade

#include "server/store/disk/workers_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "core/files/file.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class FilesOfWorkers : public StoreTest {
 protected:
  FilesOfWorkers() {
    WriteText(folder_ / "plain", "content");
    WriteText(root_.path() / "secret", "of another");
  }
  ErrorCode CodeOf(const fs::path& file, size_t max_bytes = 100) {
    return ErrorOf([&] { ReadWorkersFile(file, max_bytes); }).code();
  }

  const fs::path folder_ = root_.path() / "worker";
};

TEST_F(FilesOfWorkers, AreReadWhole) {
  EXPECT_EQ(ReadWorkersFile(folder_ / "plain", 7), "content");
  EXPECT_EQ(CodeOf(folder_ / "plain", 6), ErrorCode::kInvalidInput);
  WriteText(folder_ / "large", std::string(200'001, 'x'));
  EXPECT_EQ(ReadWorkersFile(folder_ / "large", 300'000).size(), 200'001u);
  EXPECT_EQ(CodeOf(folder_ / "large", 200'000), ErrorCode::kInvalidInput);
}

TEST_F(FilesOfWorkers, AreNothingElse) {
  fs::create_symlink(root_.path() / "secret", folder_ / "link");
  fs::create_directory_symlink(root_.path(), folder_ / "elsewhere");
  fs::create_symlink("/dev/zero", folder_ / "device");
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  fs::create_directory(folder_ / "folder");
  for (const char* name : {"link", "elsewhere/secret", "device", "pipe", "folder", "missing"})
    EXPECT_EQ(CodeOf(folder_ / name), ErrorCode::kNotFound) << name;
}

TEST_F(FilesOfWorkers, FoldersAreTakenAsTheyAre) {
  WriteText(folder_ / "run" / "out" / "map.glb", "glTF");
  TakeWorkersFolder(folder_ / "run" / "out", root_.path() / "taken");
  EXPECT_EQ(ReadFile(root_.path() / "taken" / "map.glb"), "glTF");
  EXPECT_FALSE(fs::exists(folder_ / "run" / "out"));
}

TEST_F(FilesOfWorkers, LinksToFoldersAreNotTaken) {
  WriteText(root_.path() / "other" / "out" / "map.glb", "of another");
  fs::create_directory_symlink(root_.path() / "other", folder_ / "run");
  fs::create_directory_symlink(root_.path() / "other" / "out", folder_ / "out");
  for (const fs::path& folder : {folder_ / "run" / "out", folder_ / "out", folder_ / "plain"})
    EXPECT_EQ(ErrorOf([&] { TakeWorkersFolder(folder, root_.path() / "taken"); }).code(),
              ErrorCode::kInternal)
        << folder;
  EXPECT_TRUE(fs::exists(root_.path() / "other" / "out" / "map.glb"));
}

}  // namespace
}  // namespace parkade

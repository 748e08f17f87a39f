// Workers that reach for files which are not theirs.

#include "server/jobs/walls/file_wall.h"

#include "tests/server/jobs/walls/walled.h"

namespace parkade {
namespace {

class FilesOfOthers : public Walled {
 protected:
  /// Places that this user may write in.
  std::vector<std::filesystem::path> Outside() const {
    const std::string name = root_.path().filename();
    std::vector<std::filesystem::path> files = {
        data_ / "new",        data_ / "db/main.db",    data_ / "rigs/r/rig.yaml",
        data_ / "jobs/j/new", "/tmp/" + name + ".new", "/var/tmp/" + name,
        "/dev/shm/" + name};
    if (!is_nobody()) files.push_back("/etc/" + name);
    return files;
  }
  std::string TryToWriteOutside() const {
    std::string script;
    for (const auto& file : Outside()) script += TryToWrite(file);
    return script;
  }
  std::string TryToWriteInside() const {
    return TryToWrite(folder_ / "own") + "mkdir -p " + (folder_ / "a/b").string() + "; mv " +
           (folder_ / "own").string() + " " + (folder_ / "a/b/moved").string() + "; " +
           TryToWrite(data_ / "cache/shared") + TryToWrite("/dev/null");
  }
  void ExpectOnlyInside(const std::string& printed) const {
    EXPECT_NE(printed.find("wrote " + (folder_ / "own").string()), std::string::npos) << printed;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a/b/moved")) << printed;
    EXPECT_TRUE(std::filesystem::exists(data_ / "cache/shared")) << printed;
    EXPECT_NE(printed.find("wrote /dev/null"), std::string::npos) << printed;
    for (const auto& file : Outside())
      EXPECT_EQ(printed.find("wrote " + file.string()), std::string::npos) << printed;
    EXPECT_EQ(ReadFile(data_ / "db/main.db"), "secret");
  }
};

TEST_P(FilesOfOthers, AreReadOnly) {
  const std::string printed = Printed(TryToWriteInside() + TryToWriteOutside());

  if (printed.find("may write anywhere") != std::string::npos) GTEST_SKIP() << printed;
  ExpectOnlyInside(printed);
}

TEST_P(FilesOfOthers, AreHiddenInTheDataDirectory) {
  const std::string data = data_.string();
  const std::string printed = Printed("cat " + data + "/db/main.db " + data + "/logs/other; cat " +
                                      data + "/rigs/r/rig.yaml input/a.bag; echo; cd " + data +
                                      "; find . -maxdepth 1; ls -A /run");

  if (!HasMounts(printed)) GTEST_SKIP() << printed;
  EXPECT_EQ(printed.find("secret"), std::string::npos);
  EXPECT_EQ(printed.find("log of another"), std::string::npos);
  EXPECT_NE(printed.find("a riga log"), std::string::npos) << printed;
  const std::set<std::string> seen = [&] {
    std::istringstream lines(printed.substr(printed.find("a riga log")));
    std::set<std::string> names;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) names.insert(line);
    return names;
  }();
  EXPECT_EQ(seen, (std::set<std::string>{".", "./cache", "./jobs", "./rigs"})) << printed;
}

// By whatever way a taken-over worker might try.
TEST_P(FilesOfOthers, StayOutOfReach) {
  const std::string data = data_.string();
  const std::string attack = "mount -o remount,bind,rw /; umount -l " + data +
                             "; umount -l /run; mount -t tmpfs none " + data + "; cat " + data +
                             "/db/main.db; " +
                             TryToWrite("/var/tmp/" + root_.path().filename().string());
  const std::string printed = Printed(
      "(" + attack + ") 2>&1; unshare -Urm sh -c '" + attack + "' 2>&1; nsenter -t 1 -m cat " +
      data + "/db/main.db; cat /proc/*/root" + data +
      "/db/main.db; mknod disk b $(stat -c "
      "'0x%Hd 0x%Ld' /proc/self/exe) && echo made; for disk in /dev/vd* /dev/sd* /dev/nvme*; do "
      "head -c 1 $disk > /dev/null && echo read $disk; done; cat /proc/1/mem && echo init; "
      "grep -H Cap /proc/self/status");

  if (!HasMounts(printed)) GTEST_SKIP() << printed;
  for (const char* trophy :
       {"secret\n", "secretcat", "wrote ", "\nmade\n", "\nread /dev", "init\n"})
    EXPECT_EQ(printed.find(trophy), std::string::npos) << trophy << "\n" << printed;
  EXPECT_EQ(ReadFile(data_ / "db/main.db"), "secret");
}

// A kernel that gives no mount namespaces has Landlock, perhaps.
TEST_P(FilesOfOthers, AreReadOnlyByLandlockToo) {
  AsService([&] {
    if (::unshare(CLONE_NEWUSER) != 0) ::_exit(3);
    std::ofstream("/proc/sys/user/max_mnt_namespaces") << "0" << std::flush;
    WorkerProcess({"/bin/sh", "-c", TryToWriteInside() + TryToWriteOutside()}, Place())
        .Wait(std::chrono::seconds(60));
  });

  const std::string printed = ReadFile(folder_ / "log.txt");
  if (printed.find("(Landlock)") == std::string::npos) GTEST_SKIP() << printed;
  ExpectOnlyInside(printed);
}

TEST_P(FilesOfOthers, DoNotTakeTheWorkersOwnAwayWhereItIsGone) {
  WorkerPlace place = Place();
  place.writable = {data_ / "nowhere"};
  EXPECT_THROW(WorkerProcess({"/bin/true"}, place), Error);
}

INSTANTIATE_TEST_SUITE_P(Users, FilesOfOthers, testing::Values("root", "nobody"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace parkade

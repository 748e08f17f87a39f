#pragma once

#include <fcntl.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "core/files/file.h"
#include "server/jobs/worker_process.h"
#include "tests/server/store/temporary_store.h"
#include "tests/support/sanitizers.h"

namespace parkade {

/// How many processes have this word among theirs.
inline int CountProcessesWith(const std::string& word) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream stream(entry.path() / "cmdline");
    std::string text;
    std::getline(stream, text, '\n');
    std::replace(text.begin(), text.end(), '\0', ' ');
    if (text.find(word) != std::string::npos) ++count;
  }
  return count;
}

/// Workers of a service that runs as root, or as nobody, in a data directory of that user's.
class Walled : public testing::TestWithParam<const char*> {
 protected:
  Walled() {
    WriteText(data_ / "db/main.db", "secret");
    WriteText(data_ / "logs/other", "log of another");
    WriteText(data_ / "rigs/r/rig.yaml", "a rig");
    WriteText(data_ / "jobs/j/attempt-1/input/a.bag", "a log");
    std::filesystem::create_directories(data_ / "cache");
    if (!is_nobody()) return;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root_.path())) {
      EXPECT_EQ(::lchown(entry.path().c_str(), kNobody, kNobody), 0);
    }
  }
  void SetUp() override {
    if (kHasThreadSanitizer)
      GTEST_SKIP()
          << "ThreadSanitizer has a thread in every child, which keeps it in its namespaces";
    if ((::getuid() == 0) != (GetParam() == std::string("root")) && ::getuid() != 0)
      GTEST_SKIP() << "only root can be root";
  }

  bool is_nobody() const { return ::getuid() == 0 && GetParam() == std::string("nobody"); }

  WorkerPlace Place() const {
    return {.folder = folder_,
            .log = folder_ / "log.txt",
            .temporary_files = folder_,
            .writable = {data_ / "cache"},
            .hidden = data_,
            .visible = {data_ / "rigs/r", data_ / "gone"},
            .says_walls = true};
  }
  /// Does something as the service's user, in a process of its own.
  pid_t StartAsService(const std::function<void()>& act) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    if (is_nobody() &&
        (::setgroups(0, nullptr) != 0 || ::setresgid(kNobody, kNobody, kNobody) != 0 ||
         ::setresuid(kNobody, kNobody, kNobody) != 0))
      ::_exit(1);
    ::prctl(PR_SET_DUMPABLE, 1);
    try {
      act();
      ::_exit(0);
    } catch (const std::exception& error) {
      ::_exit(2);
    }
  }
  void AsService(const std::function<void()>& act) const {
    int status = 0;
    ::waitpid(StartAsService(act), &status, 0);
    EXPECT_EQ(status, 0);
  }
  /// What a worker printed that runs `script`.
  std::string Printed(const std::string& script) const {
    AsService([&] {
      WorkerProcess({"/bin/sh", "-c", script}, Place()).Wait(std::chrono::seconds(60));
    });
    return ReadFile(folder_ / "log.txt");
  }
  /// A line of shell that says "wrote PATH" where it can write.
  static std::string TryToWrite(const std::filesystem::path& file) {
    return "(echo x > " + file.string() + ") 2> /dev/null && echo wrote " + file.string() + "; ";
  }
  bool HasMounts(const std::string& printed) const {
    return printed.find("only in its own folder (mount namespace)") != std::string::npos;
  }

  static constexpr uid_t kNobody = 65534;
  TemporaryRoot root_;
  const std::filesystem::path data_ = root_.path() / "data";
  const std::filesystem::path folder_ = data_ / "jobs/j/attempt-1";
};

}  // namespace parkade

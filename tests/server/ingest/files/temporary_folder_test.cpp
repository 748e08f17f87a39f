#include "server/ingest/files/temporary_folder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "server/ingest/files/remove_at_signal.h"
#include "server/ingest/files/temporary_file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class TemporaryFolders : public testing::Test {
 protected:
  TemporaryFolders() {
    fs::remove_all(parent_);
    fs::create_directories(parent_);
  }
  ~TemporaryFolders() override { fs::remove_all(parent_); }

  /// Another process that fills a folder until it is ended by `signal`; the status of its end.
  int EndOwnerBy(int signal) const {
    const pid_t owner = ::fork();
    if (owner == 0) {
      const RemoveAtSignal removal;
      const TemporaryFolder folder(parent_);
      for (int i = 0;; i = (i + 1) % 1000) {
        std::error_code gone;
        fs::create_directory(folder.path() / "data", gone);
        std::ofstream(folder.path() / "data" / std::to_string(i)) << "left over";
      }
    }
    const auto is_filled = [&] {
      std::error_code ignored;
      for (const auto& entry : fs::directory_iterator(parent_))
        if (fs::exists(entry.path() / "data" / "10", ignored)) return true;
      return false;
    };
    for (int i = 0; i < 1000 && !is_filled(); ++i) ::usleep(10'000);
    ::kill(owner, signal);
    int status = 0;
    ::waitpid(owner, &status, 0);
    return status;
  }

  const fs::path parent_ =
      fs::path(testing::TempDir()) / ("parkade_folders_" + std::to_string(::getpid()));
};

TEST_F(TemporaryFolders, GoWithTheirObject) {
  {
    const TemporaryFolder folder(parent_);
    const TemporaryFile file(parent_);
    std::ofstream(file.path()) << "content";
    EXPECT_NE(folder.path(), file.path().parent_path());
  }
  EXPECT_TRUE(fs::is_empty(parent_));
}

TEST_F(TemporaryFolders, GoWhenASignalEndsTheirProcess) {
  for (int i = 0; i < 20; ++i) {
    const int signal = i % 2 == 0 ? SIGTERM : SIGINT;
    const int status = EndOwnerBy(signal);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_TRUE(fs::is_empty(parent_));
  }
}

TEST_F(TemporaryFolders, OfAKilledProcessGoWhenTheNextIsMade) {
  EndOwnerBy(SIGKILL);
  EXPECT_FALSE(fs::is_empty(parent_));

  const TemporaryFolder folder(parent_);
  EXPECT_EQ(std::distance(fs::directory_iterator(parent_), {}), 1);
}

TEST_F(TemporaryFolders, OfLivingProcessesStay) {
  const TemporaryFolder first(parent_), second(parent_);
  EXPECT_TRUE(fs::exists(first.path()));
}

}  // namespace
}  // namespace parkade

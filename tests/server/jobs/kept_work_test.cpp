// What an attempt found is there for the next one.

#include "core/files/file.h"
#include "tests/server/jobs/running_jobs.h"

namespace parkade {
namespace {

TEST_F(JobRunning, WhatAnAttemptFoundIsThereForTheNext) {
  const std::string steps = "ls $5; if [ ! -e $5/a ]; then touch $5/a; kill -SEGV $$; fi; ";
  JobRunner runner(store_, events_, Shell(steps + kMakeMap));

  const Job job = WaitFor(JobState::kDone);
  runner.Stop();

  EXPECT_EQ(job.attempt, 2);
  EXPECT_TRUE(ReadFile(store_.directory.AttemptFolder(job.id, 2) / "log.txt").ends_with("\na\n"));
  EXPECT_FALSE(std::filesystem::exists(store_.directory.WorkFolder(job.id)));
}

TEST_F(JobRunning, TheLastTryAfterCrashesBeginsAnew) {
  JobRunner runner(store_, events_,
                   Shell("ls $5 | wc -l; touch $5/poison-$(date +%N); kill -SEGV $$"));

  const Job job = WaitFor(JobState::kFailed);
  runner.Stop();

  for (const auto& [attempt, found] : {std::pair(1, "0"), std::pair(2, "1"), std::pair(3, "0")})
    EXPECT_TRUE(ReadFile(store_.directory.AttemptFolder(job.id, attempt) / "log.txt")
                    .ends_with("\n" + std::string(found) + "\n"))
        << attempt;
}

TEST_F(JobRunning, AFullDiskKeepsNothing) {
  JobRunner runner(store_, events_, Shell("touch $5/a; exit 4"));

  const Job job = WaitFor(JobState::kFailed);
  runner.Stop();

  EXPECT_EQ(job.error_code, "disk_full");
  EXPECT_FALSE(std::filesystem::exists(store_.directory.WorkFolder(job.id)));
}

}  // namespace
}  // namespace parkade

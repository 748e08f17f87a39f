// A log may be made to take its worker over. What such a worker leaves where the service looks for
// its files does no harm outside its job.

#include <sys/stat.h>

#include <map>
#include <thread>

#include "core/files/file.h"
#include "server/store/tables/job_table.h"
#include "tests/server/jobs/running_jobs.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class HostileWorker : public JobRunning {
 protected:
  HostileWorker() {
    WriteText(victim_ / "map.glb", "of another");
    WriteText(victim_ / "report.json", "{}");
    WriteText(victim_ / "out" / "map.glb", "of another");
    WriteText(victim_ / "progress.ndjson", "{\"stage\": \"secret\", \"progress\": 0.5}\n");
  }
  ~HostileWorker() override { EXPECT_EQ(VictimNow(), before_); }

  using Content = std::map<std::string, std::pair<fs::perms, std::string>>;
  Content VictimNow() const {
    Content content;
    for (const auto& entry : fs::recursive_directory_iterator(victim_))
      content[entry.path()] = {entry.status().permissions(),
                               entry.is_regular_file() ? ReadFile(entry.path()) : ""};
    return content;
  }
  void Expect(const std::string& script) {
    before_ = VictimNow();
    JobRunnerOptions options = Shell("victim=" + victim_.string() + "; " + script);
    options.limits.hang = std::chrono::milliseconds(1500);
    runner_.emplace(store_, events_, options);
  }

  const fs::path victim_ = root_.path() / "victim";
  Content before_;
  std::optional<JobRunner> runner_;
};

TEST_F(HostileWorker, MakesNoMapOfAFolderElsewhere) {
  Expect("rm -r $1; ln -s $victim $1");
  const Job job = WaitFor(JobState::kFailed);
  EXPECT_EQ(job.error_code, "internal");
  EXPECT_EQ(job.error, "the worker left no folder 'out'");
}

TEST_F(HostileWorker, MakesNoMapByAFolderThatLeadsElsewhere) {
  Expect("cd ..; mv attempt-1 away; ln -s $victim attempt-1");
  EXPECT_EQ(WaitFor(JobState::kFailed).error, "the worker left no folder 'out'");
}

TEST_F(HostileWorker, DoesNotChooseWhereItsNextAttemptWrites) {
  Expect(
      "case $PWD in */attempt-1) cd ..; rm -r work; ln -s $victim work; ln -s $victim attempt-2; "
      "ln -s $victim/map.glb attempt-2.preview.glb; kill -ABRT $$;; esac; " +
      std::string(kMakeMap));
  const Job job = WaitFor(JobState::kDone);
  EXPECT_EQ(job.attempt, 2);
  runner_->Stop();
  ExpectNoLeftOvers();
}

TEST_F(HostileWorker, SaysNothingOfFilesElsewhere) {
  Expect("rm -f $2; ln -s $victim/progress.ndjson $2; sleep 1; " + std::string(kMakeMap));
  std::set<std::string> stages;
  while (JobNow().state != JobState::kDone) {
    if (const auto progress = runner_->ProgressOf(received_.job.id)) stages.insert(progress->stage);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_FALSE(stages.contains("secret"));
}

TEST_F(HostileWorker, KeepsNobodyWaitingByAPipe) {
  Expect("rm -f $2; mkfifo $2; exec sleep 1000");
  EXPECT_EQ(WaitFor(JobState::kFailed).error_code, "time_limit");
  runner_->Stop();
}

TEST_F(HostileWorker, KeepsNobodyWaitingByAPipeAmongItsProducts) {
  Expect(std::string(kMakeMap) + "mkfifo $1/pipe");
  EXPECT_EQ(WaitFor(JobState::kFailed).error,
            "the worker left 'pipe', which is neither a file nor a folder");
}

}  // namespace
}  // namespace parkade

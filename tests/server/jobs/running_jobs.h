#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/job_runner.h"
#include "server/store/tables/job_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {

/// A worker of one line of shell: $1 is the products' folder, $2 the progress
/// file, $3 the first log, $5 the folder of the work.
class JobRunning : public StoreTest {
 protected:
  static constexpr const char* kMakeMap = "echo glTF > $1/map.glb; echo '{}' > $1/report.json; ";

  JobRunnerOptions Shell(const std::string& script) {
    JobRunnerOptions options;
    options.stop_patience = std::chrono::milliseconds(300);
    options.limits.crash_pauses = {};
    options.command = [script](const JobSpec& spec) {
      const std::filesystem::path& rig = spec.rigs.at(0);
      return std::vector<std::string>{
          "/bin/sh", "-c",          script,          "worker",
          spec.out,  spec.progress, spec.logs.at(0), rig.empty() ? "none" : rig,
          spec.work};
    };
    return options;
  }
  Job JobNow() {
    return store_.database.Read(
        [&](Connection& connection) { return FindJob(connection, received_.job.id); });
  }
  Job WaitFor(JobState state) { return WaitFor(received_.job.id, state); }
  Job WaitFor(const std::string& id, JobState state) {
    const auto now = [&] {
      return store_.database.Read([&](Connection& connection) { return FindJob(connection, id); });
    };
    for (int i = 0; i < 2000 && now().state != state; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(now().state, state);
    return now();
  }
  /// What a service does at its start with the jobs of one that died.
  void StartAfterDeath() {
    JobRunnerOptions options = Shell("");
    options.num_workers = 0;
    const JobRunner runner(store_, events_, options);
  }
  void ExpectNoLeftOvers() {
    for (const std::string& name : ContentOf(store_.directory.JobsFolder())) {
      EXPECT_EQ(name.find("/out/"), std::string::npos) << name;
      EXPECT_EQ(name.find("/input/"), std::string::npos) << name;
    }
  }

  EventHub events_;
  ReceivedDrive received_ = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
};

}  // namespace parkade

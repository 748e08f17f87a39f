#pragma once

#include <algorithm>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/files/file.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/slurm/slurm_engine.h"
#include "server/store/tables/job_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {

/// A store with one job, and a fake Slurm (fake_slurm.py). The worker is a line of shell: $1 is the
/// products' folder, $2 the progress file, $3 the number of the drive to prepare, $4 the folder of
/// the work.
class SlurmTest : public StoreTest {
 protected:
  static constexpr const char* kMakeMap = "echo glTF > $1/map.glb; echo '{}' > $1/report.json; ";

  SlurmTest() {
    std::filesystem::create_directories(slurm_ / "jobs");
    for (const char* name : {"sbatch", "squeue", "scancel"})
      std::filesystem::create_symlink(FAKE_SLURM, slurm_ / name);
  }
  ~SlurmTest() override {
    runner_.reset();
    std::filesystem::remove(slurm_ / "hold");
    for (const std::string& id : JobsAtSlurm()) Set(id, {{"job_state", "CANCELLED"}});
    for (const std::string& id : JobsAtSlurm())
      if (const auto pid = At(id).value("pid", 0); pid > 0) ::kill(pid, SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }

  /// A service starts, or the next one.
  void Start(const std::string& script) {
    SlurmOptions slurm;
    slurm.commands = slurm_;
    slurm.partition = "maps";
    slurm.memory_mib = 512;
    slurm.time = std::chrono::minutes(10);
    slurm.node_program = {NODE_PROGRAM};
    slurm.poll_interval = std::chrono::milliseconds(100);
    slurm.command_patience = std::chrono::seconds(10);  // busy machines start programs slowly
    slurm.exit_patience = std::chrono::milliseconds(500);
    JobRunnerOptions options;
    options.limits.crash_pauses = {};
    options.engine = std::make_shared<SlurmEngine>(
        store_,
        [script](const JobSpec& spec) {
          return std::vector<std::string>{"/bin/sh",
                                          "-c",
                                          script,
                                          "worker",
                                          spec.out,
                                          spec.progress,
                                          std::to_string(spec.prepared),
                                          spec.work};
        },
        options.limits, slurm);
    runner_.reset();
    runner_ = std::make_unique<JobRunner>(store_, events_, options);
  }
  /// The service dies: as with a kill, nothing is written. Only its threads have to end.
  void Die() { runner_.reset(); }

  void Behave(const std::string& command, const std::string& mode) {
    WriteText(slurm_ / (command + ".mode"), mode);
  }
  void Hold() { WriteText(slurm_ / "hold", ""); }
  void Release() { std::filesystem::remove(slurm_ / "hold"); }

  std::vector<std::string> JobsAtSlurm() const {
    std::vector<std::string> ids;
    for (const auto& entry : std::filesystem::directory_iterator(slurm_ / "jobs"))
      if (entry.path().extension() == ".json") ids.push_back(entry.path().stem());
    std::sort(ids.begin(), ids.end());
    return ids;
  }
  nlohmann::json At(const std::string& id) const {
    return nlohmann::json::parse(ReadFile(slurm_ / "jobs" / (id + ".json")));
  }
  void Set(const std::string& id, const nlohmann::json& changes) {
    nlohmann::json job = At(id);
    job.update(changes);
    WriteFileAtomically(slurm_ / "jobs" / (id + ".json"), job.dump());
  }
  /// The words of each call of a command.
  std::vector<std::vector<std::string>> CallsOf(const std::string& command) const {
    std::vector<std::vector<std::string>> calls;
    std::ifstream stream(slurm_ / "calls");
    for (std::string line; std::getline(stream, line);) {
      const auto call = nlohmann::json::parse(line, nullptr, false);
      if (call.is_array() && call.at(0) == command)
        calls.push_back(call.get<std::vector<std::string>>());
    }
    return calls;
  }

  Job JobNow() {
    return store_.database.Read(
        [&](Connection& connection) { return FindJob(connection, received_.job.id); });
  }
  template <typename Probe>
  bool Eventually(const Probe& probe) {
    for (int i = 0; i < 12000; ++i) {
      if (probe()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "waited for two minutes in vain";
    return false;
  }
  Job WaitFor(JobState state) {
    Eventually([&] { return ShownState(JobNow()) == state; });
    return JobNow();
  }
  std::string WaitForId() {
    Eventually([&] { return JobNow().place && JobNow().place->id; });
    return JobNow().place->id.value_or("");
  }
  std::filesystem::path Attempt(int attempt = 1) const {
    return store_.directory.AttemptFolder(received_.job.id, attempt);
  }
  std::string ReasonNow() const {
    const auto progress = runner_->ProgressOf(received_.job.id);
    return progress ? progress->reason : "";
  }

  std::filesystem::path slurm_ = root_.path() / "slurm";
  EventHub events_;
  ReceivedDrive received_ = Receive(store_, "a log", {"a.bag", "lot", std::nullopt});
  std::unique_ptr<JobRunner> runner_;
};

}  // namespace parkade

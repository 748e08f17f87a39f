#include "server/jobs/slurm/slurm_job.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "server/jobs/slurm/slurm_options.h"

namespace parkade {
namespace {

TEST(SlurmQueueText, OfVersion22IsUnderstood) {
  const std::vector<SlurmJob> jobs = ParseSlurmQueue(R"({"meta": {}, "errors": [], "jobs": [
      {"job_id": 7, "comment": "parkade-a-1", "current_working_directory": "/data/jobs/a/attempt-1",
       "job_state": "PENDING", "state_reason": "Resources", "restart_cnt": 2, "exit_code": 0},
      {"job_id": 8, "comment": "", "current_working_directory": "/home/other", "job_state": "FAILED",
       "state_reason": "None", "restart_cnt": 0, "exit_code": 9}]})");

  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].id, "7");
  EXPECT_EQ(jobs[0].comment, "parkade-a-1");
  EXPECT_EQ(jobs[0].folder, "/data/jobs/a/attempt-1");
  EXPECT_EQ(jobs[0].reason, "Resources");
  EXPECT_EQ(jobs[0].restarts, 2);
  EXPECT_EQ(jobs[1].reason, "");
  EXPECT_EQ(jobs[1].status, 9);
}

TEST(SlurmQueueText, OfLaterVersionsIsUnderstood) {
  const std::vector<SlurmJob> jobs = ParseSlurmQueue(R"({"errors": [], "jobs": [
      {"job_id": 7, "job_state": ["FAILED"], "restart_cnt": 1,
       "exit_code": {"status": ["ERROR"], "return_code": {"set": true, "infinite": false, "number": 3},
                     "signal": {"id": {"set": false, "infinite": false, "number": 0}, "name": ""}}},
      {"job_id": 8, "job_state": ["FAILED"],
       "exit_code": {"return_code": {"set": false, "number": 0}, "signal": {"id": {"set": true, "number": 9}}}}
      ]})");

  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].state, "FAILED");
  EXPECT_EQ(jobs[0].restarts, 1);
  EXPECT_EQ(jobs[0].status, 3 << 8);
  EXPECT_EQ(jobs[1].status, 9);
}

TEST(SlurmQueueText, NonsenseIsRefused) {
  for (const char* text :
       {"", "Welcome!", "[]", "{}", R"({"jobs": 5})", R"({"jobs": [)",
        R"({"jobs": [], "errors": [{"error": "Unable to contact slurm controller"}]})"})
    EXPECT_THROW(ParseSlurmQueue(text), Error) << text;
  EXPECT_TRUE(ParseSlurmQueue(R"({"jobs": [5, {"job_id": "7"}, {"job_id": -1}, {}]})").empty());
}

TEST(SlurmId, IsDigits) {
  EXPECT_EQ(ParseSlurmId("123\n"), "123");
  EXPECT_EQ(ParseSlurmId("123;cluster\n"), "123");
  for (const char* text :
       {"", "\n", "-1\n", "12 3\n", "Submitted batch job 5\n", "9999999999999999999999\n"})
    EXPECT_THROW(ParseSlurmId(text), Error) << text;
}

TEST(SlurmState, HasAPhase) {
  const auto phase = [](const char* state) { return PhaseOf({.state = state}); };
  for (const char* state : {"PENDING", "CONFIGURING", "REQUEUED", "REQUEUE_HOLD"})
    EXPECT_EQ(phase(state), SlurmPhase::kWaiting) << state;
  for (const char* state : {"RUNNING", "COMPLETING", "SUSPENDED", "A WORD OF TOMORROW"})
    EXPECT_EQ(phase(state), SlurmPhase::kRunning) << state;
  for (const char* state : {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL",
                            "OUT_OF_MEMORY", "PREEMPTED", "BOOT_FAIL", "DEADLINE"})
    EXPECT_EQ(phase(state), SlurmPhase::kEnded) << state;
}

TEST(SlurmState, GivesTheReasonOfAnEnd) {
  using Kind = WorkerExit::Kind;
  const auto end = [](const char* state, int status = 0) {
    return ExplainSlurmEnd({.state = state, .status = status}, "track");
  };
  EXPECT_EQ(end("OUT_OF_MEMORY").code, "out_of_memory");
  EXPECT_EQ(end("OUT_OF_MEMORY").kind, Kind::kFailed) << "it would take as much again";
  EXPECT_EQ(end("TIMEOUT").code, "time_limit");
  EXPECT_EQ(end("CANCELLED").kind, Kind::kCancelled);
  EXPECT_EQ(end("PREEMPTED").kind, Kind::kReturned);
  EXPECT_EQ(end("NODE_FAIL").kind, Kind::kCrashed);
  EXPECT_EQ(end("NODE_FAIL").code, "crashed");
  EXPECT_EQ(end("FAILED", 9).sentence, "the job was killed on its node in stage 'track': Killed");
  EXPECT_EQ(end("FAILED", 127 << 8).code, "internal");
}

TEST(SlurmOptionsCheck, SaysWhatIsMissing) {
  SlurmOptions options{.memory_mib = 100, .time = std::chrono::minutes(5), .node_program = {"p"}};
  EXPECT_NO_THROW(CheckSlurmOptions(options));
  for (const char* name : {"a b", "--wrap=x", "a;b", "a,b"}) {
    SlurmOptions other = options;
    other.partition = name;
    EXPECT_THROW(CheckSlurmOptions(other), Error) << name;
  }
  options.memory_mib = 0;
  EXPECT_THROW(CheckSlurmOptions(options), Error);
}

}  // namespace
}  // namespace parkade

#include "server/jobs/slurm/slurm_job.h"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.h"

namespace parkade {
namespace {

using Json = nlohmann::json;
using Kind = WorkerExit::Kind;

constexpr std::size_t kMaxDigits = 18;

bool IsId(std::string_view text) {
  return !text.empty() && text.size() <= kMaxDigits &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Text as people may see it, "" where there is none.
std::string TextAt(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return "";
  return found->get<std::string>();
}

/// A number as 22.05 has it, or {"set": true, "number": 5} of later ones; 0 where there is none.
std::int64_t NumberAt(const Json& json, const char* key) {
  auto found = json.find(key);
  if (found == json.end()) return 0;
  const Json& value = found->is_object() ? found->value("number", Json(0)) : *found;
  return value.is_number_integer() ? value.get<std::int64_t>() : 0;
}

/// A word as 22.05 has it, or the first of the list of later ones.
std::string StateAt(const Json& json) {
  const auto found = json.find("job_state");
  if (found == json.end()) return "";
  if (found->is_string()) return found->get<std::string>();
  const bool is_list = found->is_array() && !found->empty() && found->front().is_string();
  return is_list ? found->front().get<std::string>() : "";
}

/// An exit status as 22.05 has it, or {"return_code": {...}, "signal": {...}} of later ones.
int StatusAt(const Json& json) {
  const auto found = json.find("exit_code");
  if (found == json.end()) return 0;
  if (!found->is_object()) return static_cast<int>(NumberAt(json, "exit_code"));
  const Json signal = found->value("signal", Json::object());
  const std::int64_t number = signal.is_object() ? NumberAt(signal, "id") : 0;
  return static_cast<int>(number != 0 ? number : NumberAt(*found, "return_code") << 8);
}

/// What squeue complains of, in its own words where it has some.
std::string ComplaintOf(const Json& errors) {
  const bool has_words = errors.is_array() && !errors.empty() && errors.front().is_object();
  const std::string words = has_words ? TextAt(errors.front(), "error") : "";
  return "squeue says: " + (words.empty() ? "an error without a name" : words);
}

bool IsOneOf(const std::string& word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* one) { return word == one; });
}

}  // namespace

SlurmPhase PhaseOf(const SlurmJob& job) {
  if (IsOneOf(job.state, {"PENDING", "CONFIGURING", "REQUEUED", "REQUEUE_HOLD", "REQUEUE_FED",
                          "SPECIAL_EXIT"}))
    return SlurmPhase::kWaiting;
  if (IsOneOf(job.state, {"COMPLETED", "CANCELLED", "FAILED", "TIMEOUT", "NODE_FAIL", "PREEMPTED",
                          "BOOT_FAIL", "DEADLINE", "OUT_OF_MEMORY"}))
    return SlurmPhase::kEnded;
  return SlurmPhase::kRunning;
}

std::vector<SlurmJob> ParseSlurmQueue(const std::string& json) {
  const Json queue = Json::parse(json, nullptr, /*allow_exceptions=*/false);
  const bool is_list = queue.is_object() && queue.contains("jobs") && queue["jobs"].is_array();
  Require(is_list, ErrorCode::kInternal, "squeue says no list of jobs");
  const Json errors = queue.value("errors", Json::array());
  Require(errors.empty(), ErrorCode::kInternal, ComplaintOf(errors));
  std::vector<SlurmJob> jobs;
  for (const Json& entry : queue["jobs"]) {
    if (!entry.is_object()) continue;
    SlurmJob job;
    job.id = std::to_string(NumberAt(entry, "job_id"));
    job.array_id = std::to_string(NumberAt(entry, "array_job_id"));
    job.comment = TextAt(entry, "comment");
    job.folder = TextAt(entry, "current_working_directory");
    job.state = StateAt(entry);
    job.reason = TextAt(entry, "state_reason");
    if (job.reason == "None") job.reason.clear();
    job.has_failed_to_start = TextAt(entry, "state_description").starts_with("launch failed");
    job.restarts = static_cast<int>(NumberAt(entry, "restart_cnt"));
    job.status = StatusAt(entry);
    if (IsId(job.id) && job.id != "0") jobs.push_back(std::move(job));
  }
  return jobs;
}

std::string ParseSlurmId(const std::string& output) {
  // "123\n", or "123;cluster\n".
  const std::string id = output.substr(0, output.find_first_of(";\n"));
  Require(IsId(id), ErrorCode::kInternal, "sbatch says no number of a job");
  return id;
}

WorkerExit ExplainSlurmEnd(const SlurmJob& job, const std::string& stage) {
  const std::string place = stage.empty() ? "" : " in stage '" + stage + "'";
  if (job.state == "OUT_OF_MEMORY")
    return {Kind::kFailed, "out_of_memory",
            "the job took more memory" + place + " than Slurm had for it"};
  if (IsOneOf(job.state, {"TIMEOUT", "DEADLINE"}))
    return {Kind::kFailed, "time_limit", "Slurm stopped the job" + place + " at its time limit"};
  if (job.state == "CANCELLED") return {Kind::kCancelled, "cancelled", "cancelled at Slurm"};
  if (job.state == "PREEMPTED")
    return {Kind::kReturned, "", "Slurm gave the job's place to another one"};
  if (IsOneOf(job.state, {"NODE_FAIL", "BOOT_FAIL"}))
    return {Kind::kCrashed, "crashed", "the node of the job failed" + place};
  if (WIFSIGNALED(job.status))
    return {Kind::kCrashed, "crashed",
            "the job was killed on its node" + place + ": " + ::strsignal(WTERMSIG(job.status))};
  return {Kind::kCrashed, "internal",
          "the job ended on its node with status " + std::to_string(WEXITSTATUS(job.status)) +
              place + " and left no word"};
}

}  // namespace parkade

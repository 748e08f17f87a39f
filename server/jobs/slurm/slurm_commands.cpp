#include "server/jobs/slurm/slurm_commands.h"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "core/error.h"
#include "server/jobs/slurm/run_command.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxSentence = 400;

/// What a command complained of, on one line.
std::string OneLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (text.size() > kMaxSentence) text.resize(kMaxSentence);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, ' ');
  return text;
}

}  // namespace

std::optional<int> MaxTries(const std::string& refusal) {
  // As Slurm 22.05 says it. One about nodes that are down, or busy, is not among them.
  constexpr std::array<std::string_view, 13> kFinal = {
      "Invalid account or account/partition combination",
      "Invalid partition name specified",
      "Invalid qos specification",
      "Invalid feature specification",
      "Invalid generic resource (gres) specification",
      "Requested node configuration is not available",
      "Requested nodes not in this partition",
      "Requested time limit is invalid",
      "Node count specification invalid",
      "CPU count specification invalid",
      "More processors requested than permitted",
      "Memory required by task is not available",
      "User's group not permitted to use this partition"};
  // Too large for ever, or too many jobs just now: Slurm does not say which.
  constexpr std::string_view kPolicy = "Job violates accounting/QOS policy";
  constexpr int kPolicyTries = 30;  // in half an hour
  const auto says = [&](std::string_view words) {
    return refusal.find(words) != std::string::npos;
  };
  if (std::any_of(kFinal.begin(), kFinal.end(), says)) return 1;
  return says(kPolicy) ? std::optional(kPolicyTries) : std::nullopt;
}

std::string SlurmCommands::Run(const std::string& program,
                               std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(),
                   options_.commands.empty() ? program : (options_.commands / program).string());
  const CommandResult result = RunCommand(arguments, options_.command_patience);
  const bool is_well = WIFEXITED(result.status) && WEXITSTATUS(result.status) == 0;
  Require(is_well, ErrorCode::kInternal,
          result.errors.empty() ? program + " failed" : OneLine(result.errors));
  return result.output;
}

std::string SlurmCommands::Submit(const SlurmSubmission& job) const {
  // After a node failed Slurm starts the job again by itself, also while there is no service.
  std::vector<std::string> arguments = {
      "--parsable", "--requeue", "--open-mode=append", "--job-name=parkade",
      "--comment=" + job.comment, "--nodes=1", "--ntasks=1",
      "--cpus-per-task=" + std::to_string(options_.cpus),
      "--mem=" + std::to_string(options_.memory_mib) + "M",
      "--time=" + std::to_string(options_.time.count()), "--chdir=" + job.folder.string(),
      // Relative, because Slurm reads signs into a whole path.
      "--output=log.txt",
      // It has little, and Slurm asks a login for no more.
      "--export=ALL"};
  if (job.array_size > 0) arguments.push_back("--array=0-" + std::to_string(job.array_size - 1));
  if (!job.after.empty()) arguments.push_back("--dependency=afterany:" + job.after);
  if (!options_.partition.empty()) arguments.push_back("--partition=" + options_.partition);
  arguments.push_back(job.script);
  arguments.insert(arguments.end(), options_.node_program.begin(), options_.node_program.end());
  arguments.push_back(job.folder);
  return ParseSlurmId(Run("sbatch", arguments));
}

std::vector<SlurmJob> SlurmCommands::Queue() const {
  // Slurm 22.05 lists all jobs in JSON; later ones heed the words behind.
  return ParseSlurmQueue(Run("squeue", {"--json", "--states=all", "--name=parkade"}));
}

void SlurmCommands::Cancel(const std::vector<std::string>& ids) const {
  if (!ids.empty()) Run("scancel", ids);
}

}  // namespace parkade

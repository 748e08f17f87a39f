#include "server/jobs/slurm/slurm_commands.h"

#include <sys/wait.h>

#include <algorithm>

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

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "server/commands/commands.h"
#include "server/jobs/slurm/run_on_node.h"

namespace parkade {

void AddRunAttemptCommand(CLI::App& app, Action& action) {
  const auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(kRunAttempt, "What a service has Slurm start on a node");
  command->group("");  // not for people
  command->add_option("folder", *folder, "folder of the attempt")->required();
  command->callback([folder, &action] { action = [folder] { return RunOnNode(*folder); }; });
}

}  // namespace parkade

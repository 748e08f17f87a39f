#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "server/commands/commands.h"
#include "server/ingest/files/remove_at_signal.h"
#include "server/ingest/inspection/inspect_log.h"

namespace parkade {
namespace {

struct InspectArguments {
  std::string log, rig;
  bool is_json = false;
};

int Inspect(const InspectArguments& arguments) {
  const RemoveAtSignal removal;
  const LogInspection inspection = InspectLog(arguments.log, arguments.rig);
  if (arguments.is_json) {
    // Names of topics may hold any bytes.
    const nlohmann::json json = InspectionToJson(inspection);
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    std::printf("%s", InspectionToText(inspection).c_str());
  }
  return inspection.ExitStatus();
}

}  // namespace

void AddInspectCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<InspectArguments>();
  CLI::App* command = app.add_subcommand("inspect",
                                         "Show what a drive log holds and what is missing to map "
                                         "it; exit 0 clean, 3 lossy, 1 unusable");
  command
      ->add_option("LOG", arguments->log,
                   "ROS 1 bag, MCAP, rosbag2, EuRoC folder or archive of one")
      ->required();
  command->add_option("--rig", arguments->rig,
                      "folder with the rig files, where the log itself has no calibration");
  command->add_flag("--json", arguments->is_json, "print JSON");
  command->callback([arguments, &action] { action = [arguments] { return Inspect(*arguments); }; });
}

}  // namespace parkade

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "core/files/file.h"
#include "server/commands/commands.h"
#include "server/ingest/files/remove_at_signal.h"
#include "server/ingest/inspection/inspect_log.h"

namespace parkade {
namespace {

struct InspectArguments {
  std::string log, rig, json_file;
  bool is_json = false;
};

int Inspect(const InspectArguments& arguments) {
  const RemoveAtSignal removal;
  const LogInspection inspection = InspectLog(arguments.log, arguments.rig);
  // Names of topics may hold any bytes.
  const std::string json =
      InspectionToJson(inspection).dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  if (!arguments.json_file.empty()) {
    WriteFileAtomically(arguments.json_file, json);
  } else if (arguments.is_json) {
    std::printf("%s\n", json.c_str());
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
                   "ROS 1 bag, MCAP, rosbag2, EuRoC, a folder or an archive of them")
      ->required();
  command->add_option("--rig", arguments->rig,
                      "folder with the rig files, where the log itself has no calibration");
  command->add_flag("--json", arguments->is_json, "print JSON");
  command->add_option("--json-file", arguments->json_file, "write the JSON to this file instead");
  command->callback([arguments, &action] { action = [arguments] { return Inspect(*arguments); }; });
}

}  // namespace parkade

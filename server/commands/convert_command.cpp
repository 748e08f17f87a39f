#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "server/commands/commands.h"
#include "server/ingest/conversion/convert_log.h"
#include "server/ingest/files/remove_at_signal.h"

namespace parkade {
namespace {

struct ConvertArguments {
  std::string log, rig, out;
};

int Convert(const ConvertArguments& arguments) {
  const RemoveAtSignal removal;
  OpenLogOptions options;
  options.rig_folder = arguments.rig;
  const Conversion conversion = ConvertLog(arguments.log, arguments.out, options);
  for (const ConvertedDrive& drive : conversion.drives)
    std::printf("%s: %.1f s, %llu messages, %llu left out\n", drive.file.c_str(), drive.seconds,
                static_cast<unsigned long long>(drive.num_messages),
                static_cast<unsigned long long>(drive.num_left_out));
  std::printf("%s: its rig, to be given as --rig\n", conversion.rig.c_str());
  return 0;
}

}  // namespace

void AddConvertCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = app.add_subcommand(
      "convert", "What was understood of a drive log, as a clean MCAP log of ROS 2 with its rig");
  command
      ->add_option("LOG", arguments->log,
                   "ROS 1 bag, MCAP, rosbag2, EuRoC, a folder or an archive of them")
      ->required();
  command->add_option("--rig", arguments->rig,
                      "folder with the rig files, where the log itself has no calibration");
  command
      ->add_option("--out", arguments->out,
                   "NAME.mcap; the rig comes beside it as NAME_rig, and further drives of the log "
                   "as NAME_part2.mcap, ...")
      ->required();
  command->callback([arguments, &action] { action = [arguments] { return Convert(*arguments); }; });
}

}  // namespace parkade

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "core/error.h"
#include "server/commands/commands.h"
#include "server/commands/export_map.h"

namespace parkade {
namespace {

struct ExportArguments {
  std::string map, format, out;
  ExportOptions options;
};

std::string DescribeFormats() {
  std::string text = "Formats:\n";
  for (const ExportFormat& format : ExportFormats()) {
    std::string line = "  " + format.name;
    line.resize(std::max<std::size_t>(line.size() + 1, 22), ' ');
    text += line + format.description + "\n";
  }
  return text;
}

}  // namespace

void AddExportCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "One export of a finished map");
  command->add_option("map", arguments->map, "folder that `parkade map` left")->required();
  command->add_option("--format", arguments->format, "see below")->required();
  command->add_option("--out", arguments->out, "file, or folder where the format is one")
      ->required();
  ExportOptions& options = arguments->options;
  command->add_option("--drive", options.drive,
                      "of trajectories, where the map has several drives");
  command->add_option("--spacing", options.spacing, "[m] of point clouds")->capture_default_str();
  command->add_option("--resolution", options.grid.resolution, "[m] of occupancy grids")
      ->capture_default_str();
  command->add_option("--lowest", options.grid.lowest,
                      "[m] in site: lower ground is not in the occupancy grid");
  command->add_option("--highest", options.grid.highest,
                      "[m] in site: higher ground is not in the occupancy grid");
  command->add_option("--level", options.level,
                      "the only one in lanelet2, whose readers look from above; 0 is the lowest");
  command->footer(DescribeFormats());
  command->callback([arguments, &action] {
    action = [arguments] {
      ExportMap(MapReader(arguments->map), arguments->format, arguments->out, arguments->options);
      return 0;
    };
  });
}

}  // namespace parkade

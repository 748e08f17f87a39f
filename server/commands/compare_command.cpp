#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/options_json.h"
#include "server/commands/commands.h"
#include "server/compare/compare_maps.h"

namespace parkade {
namespace {

struct CompareArguments {
  std::string from, to, out;
  std::vector<std::string> settings;
  bool is_json = false;
};

void PrintComparison(const MapComparison& comparison) {
  const SurfaceChanges& ground = comparison.ground;
  const SiteAlignment& alignment = comparison.alignment;
  std::printf("sites aligned by %s, to %.3f m and %.3f m of height\n", alignment.aligned_by.c_str(),
              alignment.horizontal_sigma, alignment.height_sigma);
  if (!alignment.note.empty()) std::printf("%s\n", alignment.note.c_str());
  std::printf("free space, m^2: %.1f unchanged\n", ground.UnchangedArea());
  for (const GroundChange change :
       {GroundChange::kFreed, GroundChange::kBlocked, GroundChange::kMapped,
        GroundChange::kUnmapped, GroundChange::kRaised, GroundChange::kLowered})
    std::printf("  %-9s %8.1f\n", ToText(change), ground.AreaOf(change));
  std::printf("heights, m: median %.3f, RMSE %.3f, 95 %% within %.3f\n", ground.height.median,
              ground.height.rmse, ground.height.percentile_95);
  for (const std::string& drive : comparison.added) std::printf("drive added: %s\n", drive.c_str());
  for (const std::string& drive : comparison.removed)
    std::printf("drive removed: %s\n", drive.c_str());
  for (const TrajectoryOffset& offset : comparison.trajectories)
    std::printf("drive %s moved, m: median %.3f, 95 %% within %.3f, largest %.3f\n",
                offset.drive.c_str(), offset.median, offset.percentile_95, offset.largest);
}

}  // namespace

void AddCompareCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand(
      "compare",
      "What changed from one finished map to another of the same place: maps that "
      "share no drive are laid on each other by "
      "places that drives of both passed");
  command->add_option("from", arguments->from, "the earlier map: a folder that `parkade map` left")
      ->required();
  command->add_option("to", arguments->to, "the later map")->required();
  command->add_option(
      "--out", arguments->out,
      "folder for changes.json, changes.geojson (regions), changes.png and .pgw (from above)");
  command->add_flag("--json", arguments->is_json, "print changes.json");
  command->add_option("--set", arguments->settings, "option=value, as min_area=0.5");
  command->callback([arguments, &action] {
    action = [arguments] {
      CompareOptions options;
      for (const std::string& setting : arguments->settings) SetOption(setting, options);
      const MapComparison comparison =
          CompareMaps(MapReader(arguments->from), MapReader(arguments->to), options);
      if (!arguments->out.empty()) WriteComparison(comparison, arguments->out);
      if (arguments->is_json)
        std::printf("%s", EncodeComparison(comparison).c_str());
      else
        PrintComparison(comparison);
      return 0;
    };
  });
}

}  // namespace parkade

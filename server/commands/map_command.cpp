#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/files/file.h"
#include "core/log.h"
#include "core/options_json.h"
#include "core/parallel.h"
#include "core/tune_malloc.h"
#include "export/write_site_map.h"
#include "mapping/networks/freespace_network.h"
#include "server/commands/commands.h"
#include "server/commands/failure.h"
#include "server/commands/map_arguments.h"
#include "server/commands/open_logs.h"
#include "server/ingest/files/remove_at_signal.h"
#include "server/map_folder/loop_images.h"
#include "server/map_folder/output_folder.h"
#include "server/map_folder/overwrite_guard.h"
#include "server/map_folder/surface_file.h"
#include "server/map_folder/write_calibration.h"
#include "server/pipeline/build_map.h"
#include "server/pipeline/gnss_fixes.h"
#include "server/pipeline/plan_stages.h"
#include "server/pipeline/prepare_drive.h"
#include "server/pipeline/report.h"
#include "server/pipeline/site_pins.h"

namespace parkade {
namespace {

std::vector<std::string> SplitAtCommas(const std::string& text) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// Removes what was found in logs of drives that could not be tracked: no folder of a drive is
/// without its odometry.
void ForgetUntracked(const OpenedLogs& logs, const std::filesystem::path& folder) {
  for (const auto& [drive, inputs] : logs.inputs)
    if (!std::filesystem::exists(folder / drive / "odometry.bin"))
      std::filesystem::remove_all(folder / drive);
}

void WriteProducts(const OpenedLogs& logs, const BuiltMap& built, const MapOptions& options,
                   Progress& progress, const std::filesystem::path& folder) {
  progress.Begin("write");
  WriteSiteMap(built.site, folder);
  WriteSurface(built.site.surface, folder / "surface.bin");
  for (size_t i = 0; i < built.site.drives.size(); ++i) {
    const SiteDrive& drive = built.site.drives[i];
    WriteLoopImages(built.drives[i].loops, drive.rig, drive.name, folder);
    WriteFileAtomically(folder / drive.name / "diagnostics.json",
                        EncodeDiagnostics(drive, built.drives[i].diagnostics,
                                          built.drives[i].odometry, built.site.datum));
    if (const auto fixes = EncodeGnssFixes(drive, built.drives[i].diagnostics.gnss,
                                           built.drives[i].gnss, built.site.datum))
      WriteFileAtomically(folder / drive.name / "gnss.json", *fixes);
    WriteFileAtomically(folder / drive.name / "keyframes.json",
                        EncodeKeyframes(drive, built.drives[i].diagnostics.keyframes));
    WriteCalibration(drive.rig, built.drives[i].odometry.calibration,
                     folder / drive.name / "calibration.yaml");
  }
  progress.Finish();
  WriteReport(built, logs.drives, options, logs.inputs, progress.timings(), folder / "report.json");
}

/// "DRIVE:LOOP", or only "LOOP" where there is one drive.
void AddDecision(const std::string& text, const std::vector<std::unique_ptr<RecordedDrive>>& drives,
                 std::vector<std::string> LoopReview::*decision, BuildScope& scope) {
  const size_t colon = text.rfind(':');
  Require(colon != std::string::npos || drives.size() == 1, ErrorCode::kUsage,
          "with several drives a loop is named DRIVE:LOOP, not '" + text + "'");
  const std::string drive =
      colon == std::string::npos ? drives.front()->name() : text.substr(0, colon);
  Require(std::any_of(drives.begin(), drives.end(),
                      [&](const auto& log) { return log->name() == drive; }),
          ErrorCode::kUsage, "no drive is called '" + drive + "'");
  (scope.loops[drive].*decision)
      .push_back(colon == std::string::npos ? text : text.substr(colon + 1));
}

/// The pins of the command line, which replace all that the map to start from has; else those.
std::vector<SitePin> PinsOf(const MapArguments& arguments, const PinOptions& options) {
  Require(arguments.pins.empty() || !arguments.from.empty(), ErrorCode::kUsage,
          "--pin needs --from: its X,Y,Z are of that map");
  Require(arguments.pins.empty() || !arguments.no_pins, ErrorCode::kUsage,
          "--pin and --no-pins exclude each other");
  if (!arguments.pins.empty()) return AnchorPins(arguments.pins, arguments.from, options);
  if (arguments.no_pins || arguments.from.empty()) return {};
  return ReadPins(arguments.from);
}

OpenLogOptions OpenOptionsOf(const MapArguments& arguments) {
  OpenLogOptions options;
  options.cameras = SplitAtCommas(arguments.cameras);
  options.use_wheels = !arguments.no_wheel;
  options.use_gnss = !arguments.no_gnss;
  return options;
}

BuildScope BuildScopeOf(const MapArguments& arguments,
                        const std::vector<std::unique_ptr<RecordedDrive>>& drives,
                        const std::filesystem::path& products) {
  BuildScope scope;
  scope.is_odometry_only = arguments.is_odometry_only;
  scope.from = arguments.from;
  scope.preview = arguments.preview;
  scope.products = products;
  scope.work = arguments.work;
  for (const std::string& loop : arguments.rejected_loops)
    AddDecision(loop, drives, &LoopReview::rejected, scope);
  for (const std::string& loop : arguments.forced_loops)
    AddDecision(loop, drives, &LoopReview::forced, scope);
  scope.links = {arguments.rejected_links, arguments.forced_links};
  return scope;
}

/// A link can be decided on that a map has: which ones there are is known once drives are joined.
void CheckLinks(const MapArguments& arguments, const std::vector<std::string>& drives) {
  const auto ends_of = [&](const std::string& id) {
    const std::optional<LinkEnds> ends = FindEnds(id, drives);
    Require(ends.has_value(), ErrorCode::kUsage,
            "'" + id + "' is no link of these drives: DRIVE:KEYFRAME~DRIVE:KEYFRAME");
    return *ends;
  };
  std::vector<LinkEnds> rejected;
  for (const std::string& id : arguments.rejected_links) rejected.push_back(ends_of(id));
  for (const std::string& id : arguments.forced_links)
    Require(std::find(rejected.begin(), rejected.end(), ends_of(id)) == rejected.end(),
            ErrorCode::kUsage, "link '" + id + "' is both rejected and forced");
}

/// Decisions on the loops of one drive, among all.
std::vector<std::string> OnlyOf(const std::string& drive, const std::vector<std::string>& all) {
  std::vector<std::string> own;
  for (const std::string& loop : all)
    if (loop.starts_with(drive + ":")) own.push_back(loop);
  return own;
}

void PrepareAndKeep(const MapArguments& all, const MapOptions& options, Progress& progress) {
  const size_t index = static_cast<size_t>(all.prepared) - 1;
  MapArguments one = all;
  one.logs = {all.logs[index]};
  if (all.rigs.size() > 1) one.rigs = {all.rigs.at(index)};
  const OutputFolder output(one.out);
  const OpenedLogs logs = OpenLogs(one.logs, one.rigs, OpenOptionsOf(one), one.skips_bad,
                                   {one.from, output.staging(), one.work, one.out});
  const std::string& name = logs.drives.front()->name();
  one.rejected_loops = OnlyOf(name, all.rejected_loops);
  one.forced_loops = OnlyOf(name, all.forced_loops);
  BuildScope scope = BuildScopeOf(one, logs.drives, output.staging());
  scope.logs[name] = logs.inputs.at(name).log.sha256;
  PrepareDrive(logs.drives.front(), options, scope, progress);
}

void BuildAndWrite(const MapArguments& arguments, const MapOptions& options, Progress& progress) {
  if (!arguments.from.empty()) MapReader(arguments.from);  // throws where there is no map
  std::vector<SitePin> pins = PinsOf(arguments, options.pins);
  OutputFolder output(arguments.out);
  const OpenedLogs logs =
      OpenLogs(arguments.logs, arguments.rigs, OpenOptionsOf(arguments), arguments.skips_bad,
               {arguments.from, output.staging(), arguments.work, arguments.out});
  RequireOverwritable(arguments.out, NamesOf(logs.drives));
  CheckLinks(arguments, NamesOf(logs.drives));
  BuildScope scope = BuildScopeOf(arguments, logs.drives, output.staging());
  scope.unreadable = logs.unreadable;
  scope.pins = std::move(pins);
  for (const auto& [name, input] : logs.inputs) scope.logs[name] = input.log.sha256;
  const BuiltMap built = BuildMap(logs.drives, options, scope, progress);
  ForgetUntracked(logs, output.staging());
  WriteProducts(logs, built, options, progress, output.staging());
  RemoveRestOfOldMap(arguments.out, output.staging());
  output.Commit();
  for (const std::string& warning : built.warnings) LogWarning(warning);
}

int RunMap(const MapArguments& arguments) {
  MapOptions options;
  for (const std::string& setting : arguments.settings) SetOption(setting, options);
  if (!arguments.loops.empty()) SetOption("loops.method=" + arguments.loops, options);
  if (!arguments.freespace_model.empty())
    options.ground.freespace_model = arguments.freespace_model;
  if (arguments.no_refine) options.refinement.enabled = false;
  if (arguments.no_wheel) options.odometry.use_wheels = false;
  if (arguments.explain_options) {
    std::printf("%s", ExplainOptions(options).c_str());
    return 0;
  }
  if (arguments.print_options) {
    std::printf("%s\n", OptionsToJson(options).dump(2).c_str());
    return 0;
  }
  Require(!arguments.logs.empty(), ErrorCode::kUsage, "map needs at least one drive log");
  Require(!arguments.out.empty(), ErrorCode::kUsage, "map needs --out DIR");
  Require(arguments.preview.empty() || !arguments.from.empty(), ErrorCode::kUsage,
          "--preview needs --from: it is that map's ground, bent");
  const bool is_prepared = arguments.prepared > 0;
  Require(!is_prepared || (!arguments.work.empty() &&
                           static_cast<size_t>(arguments.prepared) <= arguments.logs.size()),
          ErrorCode::kUsage, "--prepare needs --work, and the number of one of the logs");
  // A network that cannot be read is reported now, not after a long drive was tracked.
  if (!options.ground.freespace_model.empty()) FreespaceNetwork{options.ground.freespace_model};
  TuneMalloc();
  if (arguments.num_threads > 0) SetNumThreads(arguments.num_threads);
  const bool is_terminal = ::isatty(STDERR_FILENO) != 0;
  if (arguments.is_quiet || is_terminal) SetLogLevel(LogLevel::kWarning);

  Progress::Outputs outputs;
  outputs.terminal = is_terminal && !arguments.is_quiet;
  if (!arguments.progress_file.empty()) outputs.file = arguments.progress_file;
  Progress progress(is_prepared ? PlanPreparation()
                                : PlanStages(arguments.logs.size(), arguments.is_odometry_only),
                    outputs);
  const RemoveAtSignal removal;
  try {
    is_prepared ? PrepareAndKeep(arguments, options, progress)
                : BuildAndWrite(arguments, options, progress);
  } catch (const std::exception& exception) {
    if (!outputs.file) throw;
    // The service's worker: it has a status for each class.
    const Failure failure = FailureOf(exception);
    progress.Fail(failure.sentence, failure.code);
    std::fprintf(stderr, "parkade: %s\n", failure.sentence.c_str());
    return static_cast<int>(failure.status);
  }
  return 0;
}

}  // namespace

void AddMapCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<MapArguments>();
  CLI::App* command =
      app.add_subcommand("map", "Build one map from one or more drives of one place");
  AddMapArguments(*command, *arguments);
  command->callback([arguments, &action] { action = [arguments] { return RunMap(*arguments); }; });
}

}  // namespace parkade

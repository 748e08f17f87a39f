#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/options_json.h"
#include "tests/bench/odometry/odometry_table_report.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/bench/suite/trajectory_plot.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    R"(Runs the odometry (no loops, no map) over drives that `parkade-simulate suite` made, and fills the table of goals.
A variant is CAMERAS[-wheels]-RIG. CAMERAS: four, cam0, cam1 ... RIG: exact; nominal (as the drive's owner knows it);
an angle such as 0.3 or 1: each camera off by so many degrees and by 1 cm, 3 cm (seeded by the drive's name);
stamps: exact, but the cameras' stamps are off by 30, -30, 20, -10 ms.
Examples: parkade-odometry-table --suite SUITE --json table.json --plots plots
          parkade-odometry-table --suite SUITE --only sim1,in0 --variants four-exact,cam0-exact
          parkade-odometry-table --suite SUITE --set tracker.window=21 --json other.json)";

struct CommandLine {
  std::string suite, json_file, markdown_file, plots_folder;
  std::vector<std::string> drives, variants, assignments;
  int num_threads = 2;
  bool keeps_runs = false, is_report_only = false;
};

/// Runs of an earlier call.
std::vector<TableRun> ReadRuns(const std::string& file) {
  const nlohmann::json json = nlohmann::json::parse(ReadFile(file));
  std::vector<TableRun> runs;
  for (const nlohmann::json& run : json.at("runs")) runs.push_back(TableRunFromJson(run));
  return runs;
}

void WriteRuns(const CommandLine& line, const OdometryOptions& options,
               const std::vector<TableRun>& runs) {
  if (!line.markdown_file.empty()) WriteFileAtomically(line.markdown_file, ToMarkdown(runs));
  if (line.json_file.empty()) return;
  nlohmann::json json = {{"options", OptionsToJson(options)}, {"threads", line.num_threads}};
  json["runs"] = nlohmann::json::array();
  for (const TableRun& run : runs) json["runs"].push_back(ToJson(run));
  WriteFileAtomically(line.json_file, json.dump(1) + "\n");
}

void PrintRun(const TableRun& run) {
  std::printf(
      "%-14s %-18s %6.1f m  drift %.3f %%  ATE %.3f m  rig %.3f deg %5.1f mm %5.2f ms  %.2f of "
      "real time %4.0f MB",
      run.drive.c_str(), run.variant.c_str(), run.length, run.drift_percent, run.ate,
      run.rotation_deg, run.translation_mm, run.time_offset_ms, run.wall_seconds / run.duration,
      run.peak_memory_mb);
  std::printf("  noise");
  for (const double scale : run.noise_scales) std::printf(" %.2f", scale);
  std::printf("%s%s\n", run.error.empty() ? "" : "  ", run.error.c_str());
  std::fflush(stdout);
}

void WritePlot(const CommandLine& line, const SuiteDrive& drive,
               const std::vector<TableRun>& runs) {
  std::vector<PlottedWay> ways;
  for (const TableRun& run : runs)
    if (run.drive == drive.name && !run.world_from_imu.empty()) {
      char label[80];
      std::snprintf(label, sizeof label, "%s: %.3f %%", run.variant.c_str(), run.drift_percent);
      ways.push_back({label, run.world_from_imu});
    }
  if (ways.empty()) return;
  fs::create_directories(line.plots_folder);
  cv::imwrite((fs::path(line.plots_folder) / (drive.name + ".png")).string(),
              PlotTrajectories(drive.name + ", " + drive.scene, drive.world_from_imu, ways));
}

int Run(const CommandLine& line) {
  OdometryOptions options;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  std::vector<TableVariant> variants;
  for (const std::string& name : line.variants.empty() ? StandardVariants() : line.variants)
    variants.push_back(ParseVariant(name));
  std::vector<TableRun> runs;
  if (line.keeps_runs && fs::exists(line.json_file)) runs = ReadRuns(line.json_file);
  const auto is_known = [&](const std::string& drive, const std::string& variant) {
    return std::any_of(runs.begin(), runs.end(), [&](const TableRun& run) {
      return run.drive == drive && run.variant == variant;
    });
  };
  if (line.is_report_only) {
    std::cout << ToMarkdown(runs);
    return 0;
  }
  for (const std::string& name : line.drives.empty() ? ListSuite(line.suite) : line.drives) {
    if (std::all_of(variants.begin(), variants.end(),
                    [&](const TableVariant& v) { return is_known(name, v.name); }))
      continue;
    const SuiteDrive drive = OpenSuiteDrive(line.suite, name);
    for (const TableVariant& variant : variants) {
      if (is_known(name, variant.name)) continue;
      runs.push_back(RunVariant(drive, variant, options));
      PrintRun(runs.back());
      WriteRuns(line, options, runs);
    }
    if (!line.plots_folder.empty()) WritePlot(line, drive, runs);
  }
  std::cout << "\n" << ToMarkdown(runs);
  return std::any_of(runs.begin(), runs.end(), IsFailure) ? 1 : 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Fills the odometry's table of goals from rendered drives.",
               "parkade-odometry-table"};
  CommandLine line;
  app.footer(kFooter);
  app.add_option("--suite", line.suite, "Folder that parkade-simulate suite filled")->required();
  app.add_option("--only", line.drives, "Some drives; default: all that are there")->delimiter(',');
  app.add_option("--variants", line.variants, "Default: those of the goals")->delimiter(',');
  app.add_option("--threads", line.num_threads, "Of one run; runs go one after the other")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  app.add_option("--set", line.assignments, "Of the odometry: stage.option=value");
  app.add_option("--json", line.json_file, "Every run");
  app.add_option("--markdown", line.markdown_file, "The tables");
  app.add_option("--plots", line.plots_folder,
                 "An image per drive: ways against truth, errors over time");
  app.add_flag("--keep", line.keeps_runs, "Runs that --json holds are not run again");
  app.add_flag("--report-only", line.is_report_only,
               "Print the tables of what --json holds (with --keep), run nothing");
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}

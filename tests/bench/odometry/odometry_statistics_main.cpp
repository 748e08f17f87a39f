#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/options_json.h"
#include "tests/bench/odometry/odometry_cases.h"
#include "tests/bench/odometry/run_bench.h"

namespace parkade {
namespace {

constexpr const char* kFooter =
    R"(Each run makes a drive without images (track mode of the simulator) and estimates it. Columns:
  mean% med% worst%  drift: RMSE of positions after rigid alignment / length     fail  no answer, or drift above 5 %
  NEES rot pos       normalized estimation error squared per degree of freedom at the end of the drive, relative to its
                     start; 1 is honest. way: mean at a quarter, half, three quarters, end. honest: 95 % bounds of NEES
  deg cm ms wheel%   calibration after the drive: worst camera's rotation, place, time offset; wheel scale
  start cover speed  [s] until the start was found; share of the record covered; seconds of drive per second of computing
Examples: parkade-odometry-statistics --runs 30 --cases exact,off-large
          parkade-odometry-statistics --cases exact --set smoother.window_nodes=24 --json out.json
          parkade-odometry-statistics --cases exact --set-drive faults.time_offsets=[0.01] --set-drive cameras.rate=10)";

struct CommandLine {
  int num_runs = 10, num_threads = 1;
  double duration = 40;
  std::string scene = "lot";
  std::vector<std::string> names, odometry_assignments, drive_assignments, model_assignments;
  std::string json_file;
  bool wants_list = false, shows_runs = false;
};

void PrintRun(const StatisticsRun& run) {
  std::printf(
      "  seed %3d: %6.1f m, drift %.3f %%, start %s %.2f s, made in %.1f s (%.2f ms per image), "
      "estimated in %.1f "
      "s%s%s\n",
      run.seed, run.length, run.drift_percent, run.start_kind.c_str(), run.start_seconds,
      run.making_seconds, run.making_ms_per_image, run.estimating_seconds,
      run.error.empty() ? "" : ": ", run.error.c_str());
}

int Run(const CommandLine& line) {
  std::vector<StatisticsCase> cases = StandardCases(line.scene, line.duration);
  for (const std::string& name : line.names)
    Require(std::any_of(cases.begin(), cases.end(),
                        [&](const StatisticsCase& c) { return c.name == name; }),
            ErrorCode::kUsage, "there is no case '" + name + "'; see --list");
  nlohmann::json all = nlohmann::json::array();
  if (!line.wants_list) std::cout << TableHead() << std::endl;
  for (StatisticsCase& question : cases) {
    if (!line.names.empty() &&
        std::find(line.names.begin(), line.names.end(), question.name) == line.names.end())
      continue;
    if (line.wants_list) {
      std::cout << question.name << "\n";
      continue;
    }
    for (const std::string& assignment : line.odometry_assignments)
      SetOption(assignment, question.odometry);
    for (const std::string& assignment : line.drive_assignments)
      SetOption(assignment, question.drive.drive);
    for (const std::string& assignment : line.model_assignments)
      SetOption(assignment, question.drive.model);
    const std::vector<StatisticsRun> runs = RunCase(question, line.num_runs);
    std::cout << TableLine(question.name, runs) << std::endl;
    if (line.shows_runs)
      for (const StatisticsRun& run : runs) PrintRun(run);
    all.push_back(ToJson(question, runs));
    if (!line.json_file.empty()) WriteFileAtomically(line.json_file, all.dump(1) + "\n");
  }
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Statistics of the odometry over many simulated drives.",
               "parkade-odometry-statistics"};
  CommandLine line;
  app.footer(kFooter);
  app.add_flag("--list", line.wants_list, "Name the cases and exit");
  app.add_option("--cases", line.names, "Some of them; default: all")->delimiter(',');
  app.add_option("--runs", line.num_runs, "Seeds 1 to N")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--duration", line.duration, "[s] of each drive")->capture_default_str();
  app.add_option("--scene", line.scene, "As parkade-simulate --list")->capture_default_str();
  app.add_option("--threads", line.num_threads, "Runs at a time")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  app.add_option("--set", line.odometry_assignments, "Of the odometry: stage.option=value");
  app.add_option("--set-drive", line.drive_assignments, "Of the drive, as parkade-simulate --set");
  app.add_option("--set-model", line.model_assignments,
                 "Of the tracks: see tests/simulator/tracks/track_model.h");
  app.add_option("--json", line.json_file, "Every run, for later");
  app.add_flag("--each", line.shows_runs, "A line per run");
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/options_json.h"
#include "tests/bench/odometry/odometry_places.h"
#include "tests/bench/odometry/run_bench.h"

namespace parkade {
namespace {

constexpr const char* kFooter =
    R"(Four cameras beside each of them alone: one drive per place, made anew for every seed with other noise of IMU,
clocks and tracks, and other errors of the rig (track mode of the simulator, no images). Columns:
  all cam0 ..        drift in per cent (RMSE of positions after rigid alignment / length), root mean square over seeds
  all / best         the same ratio, of all cameras to the best single one; 95 % of resampled seeds, each with its own best
  near the luckiest  share of seeds in which all are at most 5 % worse than whichever camera was best with that seed
  wanted             share of the best single camera in that mixture of both trajectories which errs least over the
                     seeds: 0 but for chance, where all cameras waste nothing that it has
  scale              root mean square of the error of scale in per cent, all and each
With --whole-drive, a second row: the same measurements adjusted all at once, without a window.
Runs that the file of --runs has are not made again, so that a series can be stopped and filled up.
Example: parkade-odometry-places --places lot:201,street:203,garage:205 --seeds 30 --runs places.jsonl)";

struct CommandLine {
  std::vector<std::string> places = {"lot:201", "street:203", "garage:205"};
  std::vector<std::string> rigs = {"exact", "0.3", "1"};
  std::vector<std::string> odometry_assignments, drive_assignments, model_assignments;
  std::vector<std::string> refinement_assignments;
  bool is_whole_drive = false;
  int num_seeds = 12, num_threads = 1;
  double duration = 16, rate = 10;
  std::string file;
};

std::vector<PlaceRun> ReadRuns(const std::string& file) {
  std::vector<PlaceRun> runs;
  if (file.empty() || !std::filesystem::exists(file)) return runs;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    runs.push_back(PlaceRunFromJson(nlohmann::json::parse(line)));
  return runs;
}

bool IsDone(const std::vector<PlaceRun>& runs, const std::string& place, const std::string& rig,
            int seed) {
  return std::any_of(runs.begin(), runs.end(), [&](const PlaceRun& run) {
    return run.place == place && run.rig == rig && run.noise_seed == seed;
  });
}

std::vector<PlaceCase> CasesOf(const CommandLine& line) {
  std::vector<PlaceCase> cases;
  for (const std::string& name : line.places) {
    cases.push_back(ParsePlace(name, line.duration));
    simulator::TrackDriveOptions& drive = cases.back().drive;
    drive.drive.cameras.rate = line.rate;
    for (const std::string& assignment : line.drive_assignments) SetOption(assignment, drive.drive);
    for (const std::string& assignment : line.model_assignments) SetOption(assignment, drive.model);
  }
  return cases;
}

int Run(const CommandLine& line) {
  PlaceEstimators estimators;
  for (const std::string& assignment : line.odometry_assignments)
    SetOption(assignment, estimators.odometry);
  if (line.is_whole_drive) estimators.whole_drive = WholeDriveOptions();
  for (const std::string& assignment : line.refinement_assignments) {
    Require(line.is_whole_drive, ErrorCode::kUsage, "--set-refinement needs --whole-drive");
    SetOption(assignment, *estimators.whole_drive);
  }
  const std::vector<PlaceCase> cases = CasesOf(line);
  std::vector<PlaceRun> runs = ReadRuns(line.file);
  for (int seed = 1; seed <= line.num_seeds; ++seed)
    for (const PlaceCase& place : cases)
      for (const std::string& rig : line.rigs) {
        if (IsDone(runs, place.name, rig, seed)) continue;
        const std::vector<PlaceRun> made = RunPlace(place, rig, seed, estimators);
        runs.insert(runs.end(), made.begin(), made.end());
        if (line.file.empty()) continue;
        std::ofstream stream(line.file, std::ios::app);
        for (const PlaceRun& run : made) stream << ToJson(run).dump() << std::endl;
        Require(stream.good(), ErrorCode::kInternal, "could not write " + line.file);
      }
  std::cout << PlaceTable(runs);
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"The odometry of four cameras beside that of each alone, place by place.",
               "parkade-odometry-places"};
  CommandLine line;
  app.footer(kFooter);
  app.add_option("--places", line.places, "SCENE:SEED[:START], START standing, rolling or turning")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--rigs", line.rigs, "exact, 0.3 (degrees, and 1 cm), 1 (degree, and 3 cm)")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--seeds", line.num_seeds,
                 "Noises per place and rig, 1 to N; 0: only the table of --runs")
      ->capture_default_str()
      ->check(CLI::Range(0, 100000));
  app.add_option("--duration", line.duration, "[s] of each drive")->capture_default_str();
  app.add_option("--rate", line.rate, "[Hz] of images")->capture_default_str();
  app.add_option("--threads", line.num_threads)->capture_default_str()->check(CLI::Range(1, 256));
  app.add_option("--set", line.odometry_assignments, "Of the odometry: stage.option=value");
  app.add_option("--set-drive", line.drive_assignments, "Of the drive, as parkade-simulate --set");
  app.add_option("--set-model", line.model_assignments,
                 "Of the tracks: see tests/simulator/tracks/track_model.h");
  app.add_flag("--whole-drive", line.is_whole_drive,
               "Also adjusts all measurements of each drive at once (RefineDrive, no loops)");
  app.add_option("--set-refinement", line.refinement_assignments, "Of that: option=value");
  app.add_option("--runs", line.file, "A line of JSON per run, read before and added to");
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}

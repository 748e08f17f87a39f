#include <CLI/CLI.hpp>
#include <ctime>

#include "core/error.h"
#include "core/options_json.h"
#include "slam/evaluation/evaluate_trajectory.h"
#include "slam/refinement/refine_drive.h"
#include "slam/smoother/drive_measurements.h"
#include "tests/bench/odometry/odometry_cases.h"
#include "tests/bench/odometry/run_bench.h"

namespace parkade {
namespace {

struct CommandLine {
  std::vector<int> seeds = {1, 2, 3};
  double duration = 40;
  std::vector<std::string> scenes = {"lot", "garage", "street"};
  std::string name = "wheels-off-small";
  std::vector<std::string> assignments, drive_assignments;
};

double ErrorOf(const simulator::TrackDrive& drive, const Trajectory& odom_from_body) {
  return EvaluateTrajectory(drive.truth, ToTimedPoses(odom_from_body)).rigid.translation.rmse;
}

double ProcessSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void RunDrive(const StatisticsCase& question, const RefinementOptions& options) {
  const simulator::TrackDrive drive = simulator::MakeTrackDrive(question.drive, question.odometry);
  const OdometryResult odometry = EstimateTrackDrive(drive, question.odometry);
  LoopClosure open;
  open.odom_from_body = odometry.odom_from_body;
  const double begin = ProcessSeconds();
  const DriveRefinement refined = RefineDrive(odometry, drive.rig, open, options);
  const double seconds = ProcessSeconds() - begin,
               duration = odometry.odom_from_body.span().Seconds();
  std::printf("| %s | %d | %.0f | %.4f | %.4f | %s | %.3f, %.3f | %.4f | %zu in %d | %.2f |\n",
              question.drive.drive.scene.c_str(), question.drive.drive.seed, drive.length,
              ErrorOf(drive, odometry.odom_from_body), ErrorOf(drive, refined.odom_from_body),
              refined.is_accepted ? "" : refined.reason.c_str(), refined.before.unused_bearings,
              refined.after.unused_bearings, refined.wheel_scale, refined.num_nodes,
              refined.num_pieces, seconds / duration);
  std::fflush(stdout);
}

int Run(const CommandLine& line) {
  RefinementOptions options;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  std::printf(
      "| scene | seed | m | odometry, m | refined, m | refused | held-out tracks | wheels | nodes "
      "| share of the time "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : line.scenes) {
    std::vector<StatisticsCase> cases = StandardCases(scene, line.duration);
    const auto found = std::find_if(cases.begin(), cases.end(),
                                    [&](const StatisticsCase& c) { return c.name == line.name; });
    Require(found != cases.end(), ErrorCode::kUsage, "there is no case '" + line.name + "'");
    for (const std::string& assignment : line.drive_assignments)
      SetOption(assignment, found->drive.drive);
    for (const int seed : line.seeds) {
      found->drive.drive.seed = seed;
      RunDrive(*found, options);
    }
  }
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{
      "Refines simulated drives without images and without loops, and compares with the truth.",
      "parkade-refinement-statistics"};
  CommandLine line;
  app.add_option("--case", line.name, "As parkade-odometry-statistics --list")
      ->capture_default_str();
  app.add_option("--seeds", line.seeds)->delimiter(',');
  app.add_option("--scenes", line.scenes)->delimiter(',');
  app.add_option("--duration", line.duration, "[s] of each drive")->capture_default_str();
  app.add_option("--set", line.assignments, "Of the refinement: option=value");
  app.add_option("--set-drive", line.drive_assignments, "Of the drive, as parkade-simulate --set");
  constexpr int kOneThread = 1;
  return RunBench(app, argc, argv, kOneThread, [&] { return Run(line); });
}

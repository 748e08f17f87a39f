#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/files/file.h"
#include "core/options_json.h"
#include "tests/bench/loops/loop_table.h"
#include "tests/bench/odometry/run_bench.h"

namespace parkade {
namespace {

struct CommandLine {
  std::string suite, variant = "four-wheels-nominal", kept_folder, json_file, markdown_file,
                     plot_file;
  std::vector<std::string> drives, assignments,
      methods = {"none", "pnp", "scale-less", "rotation-only", "rig"};
  int num_threads = 2;
};

int Run(const CommandLine& line) {
  LoopTableOptions options;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  const TableVariant variant = ParseVariant(line.variant);
  std::vector<LoopRun> runs;
  nlohmann::json json = {{"variant", line.variant}, {"options", OptionsToJson(options)}};
  for (const std::string& name : line.drives.empty() ? ListSuite(line.suite) : line.drives) {
    const SuiteDrive drive = OpenSuiteDrive(line.suite, name);
    try {
      const std::filesystem::path kept =
          line.kept_folder.empty()
              ? ""
              : std::filesystem::path(line.kept_folder) / (name + "." + line.variant);
      const TrackedDrive tracked = TrackDrive(drive, variant, options.odometry, kept);
      for (LoopRun& run : RunLoops(drive, tracked, line.methods, options)) {
        json["runs"].push_back(ToJson(run));
        std::printf("%-12s %-14s ATE %.4f m  drift %.4f %%  %zu of %d loops, %d wrong  %.1f s\n",
                    run.drive.c_str(), run.method.c_str(), run.ate, run.drift_percent,
                    run.accepted.size(), run.num_candidates, run.num_wrong, run.seconds);
        runs.push_back(std::move(run));
      }
    } catch (const Error& error) {
      std::cerr << name << ": " << error.what() << "\n";
    }
    std::fflush(stdout);
    if (!line.json_file.empty()) WriteFileAtomically(line.json_file, json.dump(1) + "\n");
  }
  const std::string text = ToMarkdown(runs);
  std::cout << "\n" << text;
  if (!line.markdown_file.empty()) WriteFileAtomically(line.markdown_file, text);
  if (!line.plot_file.empty()) cv::imwrite(line.plot_file, PlotLoopErrors(runs));
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Closes the loops of rendered drives in all ways and compares with the truth.",
               "parkade-loop-table"};
  CommandLine line;
  app.add_option("--suite", line.suite, "Folder that parkade-simulate suite filled")->required();
  app.add_option("--only", line.drives, "Some drives; default: all that are there")->delimiter(',');
  app.add_option("--variant", line.variant,
                 "What the odometry is given, as parkade-odometry-table has it")
      ->capture_default_str();
  app.add_option("--methods", line.methods, "Some ways to close loops; none: odometry alone")
      ->delimiter(',')
      ->check(CLI::IsMember({"none", "pnp", "scale-less", "rotation-only", "rig"}));
  app.add_option("--odometry", line.kept_folder,
                 "Folder that keeps tracked drives: each is tracked once")
      ->check(CLI::ExistingDirectory);
  app.add_option("--threads", line.num_threads)->capture_default_str()->check(CLI::Range(1, 256));
  app.add_option(
      "--set", line.assignments,
      "odometry.*, loops.* or refinement.*: stage.option=value; refines=false: loops alone");
  app.add_option("--json", line.json_file, "Every run, every accepted loop");
  app.add_option("--markdown", line.markdown_file, "The table");
  app.add_option("--plot", line.plot_file, "Histograms of the loops' errors, PNG");
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}

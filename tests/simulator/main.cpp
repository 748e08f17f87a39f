#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "core/error.h"
#include "core/options_json.h"
#include "core/parallel.h"
#include "tests/simulator/simulate_drive.h"

namespace parkade::simulator {
namespace {

constexpr int kInputAtFault = 1, kUsage = 2, kOurFault = 3;  // exit status, as parkade's

struct CommandLine {
  SimulateOptions options;
  OutputPaths out;
  std::string size = "640x400";
  bool has_no_gnss = false, has_no_wheels = false, is_quiet = false, wants_list = false;
  int num_threads = 0;
  std::vector<std::string> assignments;
};

const char* const kFooter = R"(Writes, for --out DIR (an EuRoC folder):       for --out FILE.mcap or FILE.bag:
  DIR/mav0/{cam*,imu0,odom0,gnss0}               FILE.mcap  (ROS 2, CDR) or FILE.bag (ROS 1)
  DIR/rig/                                       FILE.truth/rig/
  DIR/{truth.tum,ground_truth.ply,summary.json}  FILE.truth/{truth.tum,ground_truth.ply,summary.json}
rig/ holds camchain-imucam.yaml, imu0.yaml, vehicle.yaml and a mask per camera. truth.tum is world_from_imu, the
world being the local tangent plane (x east, y north, z up). Same options, same bytes (but for summary.json's timings).
Examples: parkade-simulate lot --seed 1 --duration 40 --rate 10 --out demo-data/lot.mcap
          parkade-simulate lot --out drive --no-gnss --set sensors.imu_noise=0 --set image.noise=0)";

void AddOptions(CLI::App& app, CommandLine& line) {
  SimulateOptions& options = line.options;
  app.footer(kFooter);
  app.add_option("scene", options.scene, "Name of the scene (see --list)");
  app.add_flag("--list", line.wants_list, "Name the scenes and exit");
  app.add_option("--out", line.out.log, "FILE.bag, FILE.mcap, or a folder (EuRoC); must not exist");
  app.add_option("--truth-out", line.out.truth, "Folder of truth.tum, ground_truth.ply, summary.json");
  app.add_option("--rig-out", line.out.rig, "Folder of the rig files");
  app.add_option("--seed", options.seed, "Of the scene, the drive and all noise")->capture_default_str();
  app.add_option("--duration", options.duration, "[s]")->capture_default_str();
  app.add_option("--rate", options.cameras.rate, "Pictures per second and camera")->capture_default_str();
  app.add_option("--size", line.size, "Of the pictures")->capture_default_str();
  app.add_option("--cameras", options.rig.num_cameras, "1 to 4: front, left, right, rear")->capture_default_str();
  app.add_option("--drop", options.cameras.drop_probability, "Share of pictures that get lost")->capture_default_str();
  app.add_option("--exposure", options.image.exposure, "[s] motion blur")->capture_default_str();
  app.add_option("--line-delay", options.rig.line_delay, "[s/row] rolling shutter")->capture_default_str();
  app.add_option("--gnss", options.sensors.gnss, "standard (0.8 m), rtk (0.02 m), none")->capture_default_str();
  app.add_option("--gnss-sigma", options.sensors.gnss_sigma, "[m] horizontal; 0 = as usual for the kind")
      ->capture_default_str();
  app.add_flag("--no-gnss", line.has_no_gnss, "The same as --gnss none");
  app.add_flag("--no-wheels", line.has_no_wheels, "No wheel odometry");
  app.add_flag("--semantic", options.semantic,
               "Also masks of drivable ground: topic <camera>/semantic, PNG, 255 = drivable");
  app.add_option("--set", line.assignments, "Any option of summary.json: group.option=value");
  app.add_option("--threads", line.num_threads, "Default: all cores");
  app.add_flag("--quiet", line.is_quiet, "No progress");
}

void ApplyDerived(CommandLine& line) {
  int read = 0;
  const bool is_size =
      std::sscanf(line.size.c_str(), "%dx%d%n", &line.options.rig.width, &line.options.rig.height, &read) == 2 &&
      read == static_cast<int>(line.size.size());
  Require(is_size, ErrorCode::kUsage, "--size is of the form 640x400, not '" + line.size + "'");
  if (line.has_no_gnss) line.options.sensors.gnss = "none";
  if (line.has_no_wheels) line.options.sensors.has_wheels = false;
  for (const std::string& assignment : line.assignments) SetOption(assignment, line.options);
  Require(!line.out.log.empty(), ErrorCode::kUsage, "--out is missing: a FILE.bag, a FILE.mcap, or a folder");
  if (line.num_threads > 0) SetNumThreads(line.num_threads);
}

int Run(CommandLine& line) {
  if (line.wants_list) {
    for (const std::string& name : SceneNames()) std::cout << name << "\n";
    return 0;
  }
  ApplyDerived(line);
  const bool shows_progress = !line.is_quiet && isatty(STDERR_FILENO);
  const auto progress = [&](const std::string& stage, double fraction) {
    if (shows_progress) std::fprintf(stderr, "\r%s %3.0f %% ", stage.c_str(), 100 * fraction);
  };
  const nlohmann::json summary = SimulateDrive(line.options, line.out, progress);
  if (shows_progress) std::fprintf(stderr, "\r");
  if (!line.is_quiet)
    std::printf("%s: %.0f m in %.0f s, %d images (%.3f s each)\n", line.out.log.c_str(),
                summary["drive"]["length_m"].get<double>(), summary["drive"]["duration_s"].get<double>(),
                summary["counts"]["images"].get<int>(), summary["timings"]["render_s_per_image"].get<double>());
  return 0;
}

}  // namespace
}  // namespace parkade::simulator

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Makes a drive with four fisheye cameras, IMU, wheels and GNSS, with its exact truth.",
               "parkade-simulate"};
  simulator::CommandLine line;
  simulator::AddOptions(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : simulator::kUsage;
  }
  try {
    return simulator::Run(line);
  } catch (const Error& error) {
    std::cerr << "parkade-simulate: " << error.what() << "\n";
    if (error.code() == ErrorCode::kUsage) return simulator::kUsage;
    return error.code() == ErrorCode::kInternal ? simulator::kOurFault : simulator::kInputAtFault;
  } catch (const std::exception& error) {
    std::cerr << "parkade-simulate: " << error.what() << "\n";
    return simulator::kOurFault;
  }
}

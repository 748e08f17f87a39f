#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "core/error.h"
#include "core/options_json.h"
#include "core/parallel.h"
#include "tests/simulator/drives/presets.h"
#include "tests/simulator/drives/run_suite.h"
#include "tests/simulator/drives/simulate_drive.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/sinks/truth_files.h"

namespace parkade::simulator {
namespace {

constexpr int kInputAtFault = 1, kUsage = 2, kOurFault = 3;  // exit status, as parkade's

struct CommandLine {
  SimulateOptions options;
  std::string scene;
  OutputPaths out;
  std::string size = "640x400";
  std::string height_at, kerbs_file, ground_file;
  bool has_no_gnss = false, has_no_wheels = false, is_quiet = false, wants_list = false,
       is_quick = false;
  int num_threads = 0;
  std::vector<std::string> assignments, names;
};

const char* const kFooter =
    R"(Writes, for --out DIR (an EuRoC folder):       for --out FILE.mcap or FILE.bag:
  DIR/mav0/{cam*,imu0,odom0,gnss0}               FILE.mcap  (ROS 2, CDR) or FILE.bag (ROS 1)
  DIR/{rig,rig_true}/                            FILE.truth/{rig,rig_true}/
  DIR/{truth.tum,ground_truth.ply,               FILE.truth/{truth.tum,ground_truth.ply,
       slots.geojson,kerbs.geojson,                          slots.geojson,kerbs.geojson,
       summary.json}                                         summary.json}
rig/ holds camchain-imucam.yaml, imu0.yaml, vehicle.yaml and a mask per camera, as the owner of the car knows them;
rig_true/ the same as they are (rig_true_knocked/ after a mirror was hit). truth.tum is world_from_imu, the world being
the local tangent plane (x east, y north, z up). Same options, same bytes (but for summary.json's timings).
Examples: parkade-simulate lot --seed 1 --duration 24 --rate 5 --out demo-data/lot.mcap
          parkade-simulate out8 --quick --out drive.bag
          parkade-simulate lot --out drive --no-gnss --set sensors.imu_noise=0 --set image.noise=0
          parkade-simulate suite --quick --out build/suite --only out8 --only out11

The driver, by --set drive.NAME=VALUE: length [m], max_speed [m/s], stops=[5,60] [s each], initial_stand, final_stand
[s], rolling_start [m/s], is_opposite, drives_last_part, turns_around, parks (backs into a slot at the end), parked_stand [s],
leaves_slot, suspension. Sensors, by --set sensors.NAME=VALUE: imu=mems|rt3000, imu_rate [Hz], imu_noise,
wheel_scale_error, wheel_noise, wheel_slips, gnss_multipath [per minute], gnss_memory [s].

)";

void AddOptions(CLI::App& app, CommandLine& line) {
  SimulateOptions& options = line.options;
  app.footer(kFooter + std::string(kFaultHelp));
  app.add_option("scene", line.scene, "A scene, a preset (see --list), or 'suite': all presets");
  app.add_flag("--list", line.wants_list, "Name the scenes and presets and exit");
  app.add_flag("--quick", line.is_quick, "Of a preset or the suite: in short, 10 Hz, 640x400");
  app.add_option("--only", line.names, "Of the suite: this preset (may be repeated)");
  app.add_option("--height", line.height_at,
                 "X,Y[,Z]: print the ground's true height there (nearest to Z) and exit");
  app.add_option("--kerbs", line.kerbs_file,
                 "FILE: write the true kerbs of the place (GeoJSON) and exit");
  app.add_option("--ground", line.ground_file,
                 "FILE: write the true drivable ground of the place (PLY) and exit");
  app.add_option("--out", line.out.log, "FILE.bag, FILE.mcap, or a folder (EuRoC); must not exist");
  app.add_option("--truth-out", line.out.truth,
                 "Folder of truth.tum, ground_truth.ply, summary.json");
  app.add_option("--rig-out", line.out.rig, "Folder of the rig files");
  app.add_option("--seed", options.seed, "Of the scene, the drive and all noise")
      ->capture_default_str();
  app.add_option("--place-seed", options.place_seed, "Of the place alone; -1: --seed")
      ->capture_default_str();
  app.add_option("--day", options.day, "Other parked cars and light at the same place")
      ->capture_default_str();
  app.add_option("--speed-bumps", options.speed_bumps, "Of a lot, 0 to 4")->capture_default_str();
  app.add_option("--traffic", options.traffic, "Cars that move, and as many people")
      ->capture_default_str();
  app.add_option("--weather", options.weather,
                 "dry, overcast, wet, dusk; default: as the day wants it");
  app.add_option_function<double>(
         "--duration",
         [&](double seconds) {
           options.duration = seconds;
           options.drive.length = 0;
         },
         "[s]")
      ->default_str("40");
  app.add_option("--length", options.drive.length,
                 "[m] to drive, instead of a duration; 0: --duration counts")
      ->capture_default_str();
  app.add_option("--rate", options.cameras.rate, "Images per second and camera")
      ->capture_default_str();
  app.add_option("--size", line.size, "Of the images")->capture_default_str();
  app.add_option("--cameras", options.rig.num_cameras, "1 to 4: front, left, right, rear")
      ->capture_default_str();
  app.add_option("--drop", options.cameras.drop_probability, "Share of images that get lost")
      ->capture_default_str();
  app.add_option("--exposure", options.image.exposure, "[s] motion blur; 0: as the light wants it")
      ->capture_default_str();
  app.add_option("--line-delay", options.rig.line_delay, "[s/row] rolling shutter")
      ->capture_default_str();
  app.add_option("--lens", options.rig.lens,
                 "Model of the fisheyes: kb (equidistant), omni, eucm, ds, ocam")
      ->capture_default_str();
  app.add_option("--gnss", options.sensors.gnss, "standard (1.5 m), rtk (0.02 m), none")
      ->capture_default_str();
  app.add_option("--gnss-sigma", options.sensors.gnss_sigma,
                 "[m] horizontal; 0 = as usual for the kind")
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
  const bool is_size = std::sscanf(line.size.c_str(), "%dx%d%n", &line.options.rig.width,
                                   &line.options.rig.height, &read) == 2 &&
                       read == static_cast<int>(line.size.size());
  Require(is_size, ErrorCode::kUsage, "--size is of the form 640x400, not '" + line.size + "'");
  if (line.has_no_gnss) line.options.sensors.gnss = "none";
  if (line.has_no_wheels) line.options.sensors.has_wheels = false;
  SetOptions(line.assignments,
             line.options);  // at once: begin and end of a fault are valid together only
  Require(!line.out.log.empty(), ErrorCode::kUsage,
          "--out is missing: a FILE.bag, a FILE.mcap, or a folder");
  if (line.num_threads > 0) SetNumThreads(line.num_threads);
}

void PrintList() {
  std::printf("scenes:\n");
  for (const std::string& name : SceneNames()) std::printf("  %s\n", name.c_str());
  std::printf("presets, with their length (and that of the quick form):\n");
  for (const Preset& preset : Presets())
    std::printf("  %-13s %4.0f m (%3.0f m)  %s\n", preset.name.c_str(), preset.options.drive.length,
                QuickForm(preset.options).drive.length, preset.character.c_str());
}

void PrintHeight(const CommandLine& line) {
  double x = 0, y = 0, near_z = 0;
  Require(std::sscanf(line.height_at.c_str(), "%lf,%lf,%lf", &x, &y, &near_z) >= 2,
          ErrorCode::kUsage, "--height is of the form X,Y or X,Y,Z");
  const Place place = PlanPlace(line.options.scene, line.options.OfScene());
  std::printf("%.4f\n", place.ground.Height({x, y}, near_z));
}

/// What a drive writes beside its log, without a drive: for logs of older versions.
void WriteKerbsOf(const CommandLine& line) {
  SceneOptions options = line.options.OfScene();
  options.ground_texel = 0.2;  // nobody looks at it
  WriteKerbs(BuildScene(line.options.scene, options).kerbs, SimulatedDatum(), line.kerbs_file);
}

void WriteGroundOf(const CommandLine& line) {
  WritePly(DrivableSurface(PlanPlace(line.options.scene, line.options.OfScene())),
           line.ground_file);
}

int MakeSuite(const CommandLine& line) {
  if (line.num_threads > 0) SetNumThreads(line.num_threads);
  const std::filesystem::path folder = line.out.log.empty() ? "build/suite" : line.out.log;
  RunSuite(ChoosePresets(line.names, line.is_quick), folder, std::cout);
  return 0;
}

int Run(CommandLine& line) {
  if (line.wants_list) return PrintList(), 0;
  if (line.scene == "suite") return MakeSuite(line);
  if (!line.scene.empty() && !FindPreset(line.scene)) line.options.scene = line.scene;
  if (!line.height_at.empty()) return PrintHeight(line), 0;
  if (!line.kerbs_file.empty()) return WriteKerbsOf(line), 0;
  if (!line.ground_file.empty()) return WriteGroundOf(line), 0;
  ApplyDerived(line);
  const bool shows_progress = !line.is_quiet && isatty(STDERR_FILENO);
  const auto progress = [&](const std::string& stage, double fraction) {
    if (shows_progress) std::fprintf(stderr, "\r%s %3.0f %% ", stage.c_str(), 100 * fraction);
  };
  const nlohmann::json summary = SimulateDrive(line.options, line.out, progress);
  if (shows_progress) std::fprintf(stderr, "\r");
  if (!line.is_quiet)
    std::printf("%s: %.0f m in %.0f s, %d images (%.3f s each)\n", line.out.log.c_str(),
                summary["drive"]["length_m"].get<double>(),
                summary["drive"]["duration_s"].get<double>(),
                summary["counts"]["images"].get<int>(),
                summary["timings"]["render_s_per_image"].get<double>());
  return 0;
}

/// A preset's options come first, so that the other words of the command line change them.
void ApplyPreset(int argc, char** argv, CommandLine& line) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto preset = std::find_if(words.begin(), words.end(), [](const std::string& word) {
    return FindPreset(word) != nullptr;
  });
  if (preset == words.end()) return;
  line.options = FindPreset(*preset)->options;
  const bool is_quick = std::find(words.begin(), words.end(), "--quick") != words.end();
  if (is_quick) line.options = QuickForm(line.options);
  line.size =
      std::to_string(line.options.rig.width) + "x" + std::to_string(line.options.rig.height);
}

}  // namespace
}  // namespace parkade::simulator

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{
      "Makes a drive with four fisheye cameras, IMU, wheels and GNSS, with its exact truth.",
      "parkade-simulate"};
  simulator::CommandLine line;
  simulator::ApplyPreset(argc, argv, line);
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

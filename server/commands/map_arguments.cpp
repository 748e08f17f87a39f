#include "server/commands/map_arguments.h"

#include <CLI/CLI.hpp>

namespace parkade {
namespace {

void AddInputs(CLI::App& command, MapArguments& arguments) {
  command.add_option("LOG", arguments.logs,
                     "ROS 1 bag, MCAP, rosbag2, EuRoC, a folder or an archive of them");
  command
      .add_option("--rig", arguments.rigs,
                  "folder with camchain-imucam.yaml, imu0.yaml and vehicle.yaml; once for all "
                  "logs or once for each, "
                  "in their order ('-': the log's own)")
      ->allow_extra_args(false);
  command.add_flag(
      "--skip-bad", arguments.skips_bad,
      "of several logs, leave out with a warning those that cannot be used, instead of "
      "ending with status 1");
  command.add_option("--out", arguments.out, "folder for the map; made where missing");
  command.add_option(
      "--work", arguments.work,
      "folder for results of stages, which outlives a run that was ended: the next one with the "
      "same inputs goes on where it was");
  command.add_option("--cameras", arguments.cameras, "use these cameras only: cam0,cam2");
  command.add_flag("--no-wheel", arguments.no_wheel, "leave wheel odometry out");
  command.add_flag("--no-gnss", arguments.no_gnss, "leave GNSS out");
  command.add_option(
      "--loops", arguments.loops,
      "how loops are closed: rig (default; all cameras against metric points), scale-less, "
      "rotation-only, pnp (one camera each, as in the literature) or none");
  command.add_option(
      "--freespace-model", arguments.freespace_model,
      "ONNX network that finds drivable ground, instead of the built-in one (docs/freespace.md)");
}

/// What is taken from a finished map, and what reviewers have decided on it.
void AddDecisions(CLI::App& command, MapArguments& arguments) {
  command.add_option(
      "--from", arguments.from,
      "finished map: its odometry is taken for the drives it has, which are not tracked again");
  command.add_option(
      "--preview", arguments.preview,
      "FILE.glb: the ground of the map --from, bent as trajectories have: written as soon as other "
      "loops are closed, and again once trajectories are final");
  command
      .add_option("--reject-loop", arguments.rejected_loops,
                  "[DRIVE:]LOOP, by the id in report.json: never closed")
      ->allow_extra_args(false);
  command
      .add_option("--force-loop", arguments.forced_loops,
                  "[DRIVE:]LOOP: closed without doubt, where the images allow to measure it")
      ->allow_extra_args(false);
  command
      .add_option("--reject-link", arguments.rejected_links,
                  "DRIVE:KEYFRAME~DRIVE:KEYFRAME, a link of two drives in report.json: it does not "
                  "join them")
      ->allow_extra_args(false);
  command
      .add_option("--force-link", arguments.forced_links,
                  "DRIVE:KEYFRAME~DRIVE:KEYFRAME: a link that is not doubted")
      ->allow_extra_args(false);
  command
      .add_option(
          "--pin", arguments.pins,
          "[DRIVE:]X,Y,Z=LAT,LON[,HEIGHT]: where a point of the map --from lies on Earth, meters "
          "in its site, "
          "degrees, meters above the ellipsoid; two or more, which stand for those that map has")
      ->allow_extra_args(false);
  command.add_flag("--no-pins", arguments.no_pins, "leave out the pins of the map --from");
}

void AddRunOptions(CLI::App& command, MapArguments& arguments) {
  command.add_flag("--no-refine", arguments.no_refine,
                   "no adjustment of the whole drive after loops are closed");
  command.add_flag("--odometry-only", arguments.is_odometry_only, "trajectories, no surface");
  command.add_option("--set", arguments.settings,
                     "stage.option=value; --explain-options lists them");
  command.add_flag("--print-options", arguments.print_options, "print all options as JSON and end");
  command.add_flag("--explain-options", arguments.explain_options,
                   "print all options with what they do, their ranges and units, and end");
  command.add_option("--threads", arguments.num_threads, "threads to use; default: all cores")
      ->check(CLI::Range(1, 1024));
  command.add_flag("--quiet", arguments.is_quiet, "warnings and errors only");
  command.add_option(
      "--progress-file", arguments.progress_file,
      "append progress as lines of JSON; exit status 4 then is a full disk, 5 want of "
      "memory");
  // For a service that prepares the drives of a site on several machines.
  command
      .add_option("--prepare", arguments.prepared,
                  "only put into --work what the drive with this number needs by itself")
      ->check(CLI::PositiveNumber)
      ->group("");
}

}  // namespace

void AddMapArguments(CLI::App& command, MapArguments& arguments) {
  AddInputs(command, arguments);
  AddDecisions(command, arguments);
  AddRunOptions(command, arguments);
}

}  // namespace parkade

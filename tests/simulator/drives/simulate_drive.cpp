#include "tests/simulator/drives/simulate_drive.h"

#include <chrono>

#include "core/error.h"
#include "core/files/file.h"
#include "tests/simulator/drives/drive_summary.h"
#include "tests/simulator/drives/record_drive.h"
#include "tests/simulator/faults/faulty_rig.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/scenes/traffic.h"
#include "tests/simulator/sinks/open_drive_sink.h"
#include "tests/simulator/sinks/truth_files.h"

namespace parkade::simulator {
namespace {

namespace fs = std::filesystem;

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The cameras to take images with: those of the rig, and a knocked one behind them.
Rig CamerasToRender(const Rig& rig, const MirrorMove& mirror) {
  Rig cameras = rig;
  const size_t camera = static_cast<size_t>(mirror.camera);
  if (mirror.angle_deg != 0 && camera < rig.cameras.size())
    cameras.cameras.push_back(KnockedCamera(rig.cameras[camera], mirror.angle_deg));
  return cameras;
}

/// A rig names only what the log has.
void NameOnlyWhatIsThere(const SensorRecords& records, Rig& rig) {
  if (records.wheels.empty()) rig.vehicle->wheel_topic.clear();
  if (records.gnss.empty()) rig.vehicle->gnss_topic.clear();
}

void WriteRigTo(const Rig& rig, const OutputPaths& out, const fs::path& folder) {
  fs::create_directories(folder);
  WriteRig(RigForOutput(rig, out.log), folder);
}

/// `rig` is the true one.
void WriteRigs(const Rig& rig, const SimulateOptions& options, const OutputPaths& out,
               const fs::path& truth) {
  WriteRigTo(NominalRig(rig, options.faults, static_cast<std::uint64_t>(options.seed)), out,
             out.rig.empty() ? truth / "rig" : out.rig);
  WriteRigTo(rig, out, truth / "rig_true");
  const MirrorMove& mirror = options.faults.mirror;
  const size_t camera = static_cast<size_t>(mirror.camera);
  if (mirror.angle_deg == 0 || camera >= rig.cameras.size()) return;
  Rig knocked = rig;
  knocked.cameras[camera] = KnockedCamera(rig.cameras[camera], mirror.angle_deg);
  WriteRigTo(knocked, out, truth / "rig_true_knocked");
}

}  // namespace

fs::path DefaultTruthFolder(const fs::path& log) {
  if (!IsLogFile(log)) return log;
  fs::path folder = log;
  return folder.replace_extension(".truth");
}

nlohmann::json SimulateDrive(const SimulateOptions& options, const OutputPaths& out,
                             const ProgressListener& progress) {
  options.Validate();
  RequireNewOutput(out.log);
  Require(IsLogFile(out.log) || options.rig.lens == RigOptions{}.lens, ErrorCode::kUsage,
          "a EuRoC folder has no words for this lens: write a .bag or an .mcap");
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  const auto start = std::chrono::steady_clock::now();
  progress("build the scene", 0);
  Scene scene = BuildScene(options.scene, options.OfScene());
  Rig rig = TrueRig(MakeSimulatedRig(options.rig, seed), options.faults);
  rig.imu =
      CalibrationOf(ImuGradeNamed(options.sensors.imu), options.sensors.imu_rate, rig.imu.topic);
  const Rig cameras = CamerasToRender(rig, options.faults.mirror);
  const DrivePlan plan = PlanDrive(scene.place, options.drive, options.duration, seed);
  AddTraffic(scene, plan.motion, options.traffic, seed);
  const Renderer renderer(scene, cameras, kHalfFieldOfView);
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera)
    rig.cameras[camera].mask = renderer.Mask(camera);
  const double scene_seconds = SecondsSince(start);

  SimulateOptions applied = options;
  if (applied.image.exposure == 0) applied.image.exposure = scene.usual_exposure;
  const SensorRecords records = SimulateSensors(applied, plan.motion, rig, scene.place.is_covered);
  NameOnlyWhatIsThere(records, rig);
  const std::unique_ptr<DriveSink> sink =
      OpenDriveSink(out.log, NominalRig(rig, options.faults, seed));
  const Recording recording =
      RecordDrive(applied, plan.motion, rig, renderer, records, *sink, progress);

  const fs::path truth = out.truth.empty() ? DefaultTruthFolder(out.log) : out.truth;
  fs::create_directories(truth);
  WriteRigs(rig, options, out, truth);
  WriteTruthTrajectory(plan.motion, rig.body_from_imu, DriveEpoch(seed), truth / "truth.tum");
  WritePly(DrivableSurface(scene.place), truth / "ground_truth.ply");
  WriteSlots(scene.place, SimulatedDatum(), truth / "slots.geojson");
  WriteKerbs(scene.kerbs, SimulatedDatum(), truth / "kerbs.geojson");
  nlohmann::json summary = SummaryOf(options, plan, recording.counts);
  const double num_images = static_cast<double>(std::max<size_t>(1, recording.counts.images));
  summary["timings"] = {{"scene_s", scene_seconds},
                        {"all_s", SecondsSince(start)},
                        {"render_s_per_image", recording.times.render / num_images},
                        {"encode_s_per_image", recording.times.encode / num_images}};
  WriteFileAtomically(truth / "summary.json", summary.dump(2) + "\n");
  return summary;
}

}  // namespace parkade::simulator

#include "tests/simulator/simulate_drive.h"

#include <chrono>

#include "core/error.h"
#include "core/file.h"
#include "core/options_json.h"
#include "tests/simulator/drive_sink.h"
#include "tests/simulator/plan_drive.h"
#include "tests/simulator/random.h"
#include "tests/simulator/renderer.h"
#include "tests/simulator/truth_files.h"

namespace parkade::simulator {
namespace {

namespace fs = std::filesystem;

constexpr double kImageMargin = 0.1;  // [s] without images at both ends, so that every exposure lies within the motion

class Stopwatch {
 public:
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Everything that is recorded without a camera.
struct SensorRecords {
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<GnssFix> gnss;
};

/// Hands over the records up to `time`, merged in order of time.
class RecordFeeder {
 public:
  RecordFeeder(const SensorRecords& records, DriveSink& sink) : records_(records), sink_(sink) {}

  void FeedUntil(Timestamp time) {
    while (true) {
      const Timestamp imu = TimeAt(records_.imu, next_imu_), wheels = TimeAt(records_.wheels, next_wheels_),
                      gnss = TimeAt(records_.gnss, next_gnss_);
      const Timestamp first = std::min({imu, wheels, gnss});
      if (first > time || first == kNever) return;
      if (first == imu)
        sink_.Write(records_.imu[next_imu_++]);
      else if (first == wheels)
        sink_.Write(records_.wheels[next_wheels_++]);
      else
        sink_.Write(records_.gnss[next_gnss_++]);
    }
  }
  void FeedAll() { FeedUntil(kNever); }

 private:
  static constexpr Timestamp kNever{std::numeric_limits<std::int64_t>::max()};

  template <typename Sample>
  static Timestamp TimeAt(const std::vector<Sample>& samples, size_t index) {
    return index < samples.size() ? samples[index].time : kNever;
  }

  const SensorRecords& records_;
  DriveSink& sink_;
  size_t next_imu_ = 0, next_wheels_ = 0, next_gnss_ = 0;
};

struct CameraStats {
  size_t num_images = 0;
  double render_seconds = 0, encode_seconds = 0;
  size_t num_bytes = 0;
};

/// Renders all scheduled frames and writes them, with the other records, in order of time.
CameraStats Record(const SimulateOptions& options, const Motion& motion, const Rig& rig, const Renderer& renderer,
                   const SensorRecords& records, DriveSink& sink, const ProgressListener& progress) {
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  const Timestamp epoch = DriveEpoch(seed);
  std::vector<ImageSensor> image_sensors;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera)
    image_sensors.emplace_back(options.image, Mix64(seed) + camera);
  const std::vector<ScheduledFrame> frames =
      ScheduleFrames(motion, rig.cameras.size(), options.cameras, kImageMargin, seed);
  RecordFeeder feeder(records, sink);
  CameraStats stats;
  Stopwatch watch;
  for (const ScheduledFrame& frame : frames) {
    feeder.FeedUntil(frame.time);
    Shot shot;
    shot.camera = frame.camera;
    shot.world_from_body = [&](double offset) { return motion.WorldFromBody(frame.time - epoch + offset); };
    shot.exposure = options.image.exposure;
    shot.with_semantics = options.semantic;
    watch.Lap();
    const RenderedImage rendered = renderer.Render(shot);
    stats.render_seconds += watch.Lap();
    const std::vector<std::uint8_t> jpeg =
        EncodeJpeg(image_sensors[frame.camera].Develop(rendered.radiance), options.image.jpeg_quality);
    sink.WriteImage(frame.camera, frame.time, jpeg);
    if (options.semantic) sink.WriteSemantic(frame.camera, frame.time, EncodePng(rendered.drivable));
    stats.encode_seconds += watch.Lap();
    stats.num_bytes += jpeg.size();
    progress("render", static_cast<double>(++stats.num_images) / static_cast<double>(frames.size()));
  }
  feeder.FeedAll();
  return stats;
}

nlohmann::json Summary(const SimulateOptions& options, const DrivePlan& plan, const SensorRecords& records,
                       const CameraStats& images) {
  nlohmann::json summary;
  summary["options"] = OptionsToJson(options);
  summary["drive"] = {{"length_m", plan.length},
                      {"duration_s", plan.motion.Duration()},
                      {"max_speed_m_per_s", plan.max_speed},
                      {"min_radius_m", plan.min_radius},
                      {"returns_to_start", plan.returns_to_start}};
  const SiteDatum datum = SimulatedDatum();
  summary["datum"] = {
      {"latitude_deg", datum.latitude_deg}, {"longitude_deg", datum.longitude_deg}, {"altitude", datum.altitude}};
  summary["counts"] = {{"images", images.num_images},
                       {"image_bytes", images.num_bytes},
                       {"imu", records.imu.size()},
                       {"wheels", records.wheels.size()},
                       {"gnss", records.gnss.size()}};
  return summary;
}

}  // namespace

void SimulateOptions::Validate() const {
  Require(seed >= 0, ErrorCode::kUsage, "the seed must not be negative");
  Require(duration >= 10 && duration <= 3600, ErrorCode::kUsage, "the duration must be 10 to 3600 s");
  Require(relief >= 0 && relief <= 3, ErrorCode::kUsage, "the relief must be 0 to 3");
  Require(ground_texel >= 0.002 && ground_texel <= 0.2, ErrorCode::kUsage,
          "the ground's texels must be 0.002 to 0.2 m");
  rig.Validate();
  sensors.Validate();
  cameras.Validate();
  image.Validate();
}

fs::path DefaultTruthFolder(const fs::path& log) {
  if (!IsLogFile(log)) return log;
  fs::path folder = log;
  return folder.replace_extension(".truth");
}

nlohmann::json SimulateDrive(const SimulateOptions& options, const OutputPaths& out, const ProgressListener& progress) {
  options.Validate();
  RequireNewOutput(out.log);
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  Stopwatch watch;
  progress("build the scene", 0);
  const Scene scene = BuildScene(options.scene, {seed, options.relief, options.ground_texel});
  Rig rig = MakeSimulatedRig(options.rig, seed);
  const Renderer renderer(scene, rig, kHalfFieldOfView);
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) rig.cameras[camera].mask = renderer.Mask(camera);
  const DrivePlan plan = PlanDrive(scene.place, options.duration, seed);
  const double scene_seconds = watch.Lap();

  SensorRecords records;
  records.imu = SimulateImu(plan.motion, rig, options.sensors, seed);
  if (options.sensors.has_wheels) records.wheels = SimulateWheels(plan.motion, options.sensors, seed);
  records.gnss = SimulateGnss(plan.motion, rig, SimulatedDatum(), options.sensors, seed);
  // A rig names only what the log has.
  if (records.wheels.empty()) rig.vehicle->wheel_topic.clear();
  if (records.gnss.empty()) rig.vehicle->gnss_topic.clear();
  const std::unique_ptr<DriveSink> sink = MakeDriveSink(out.log, rig);
  const CameraStats images = Record(options, plan.motion, rig, renderer, records, *sink, progress);
  sink->Close();

  const fs::path truth = out.truth.empty() ? DefaultTruthFolder(out.log) : out.truth;
  const fs::path rig_folder = out.rig.empty() ? truth / "rig" : out.rig;
  fs::create_directories(truth);
  fs::create_directories(rig_folder);
  WriteRig(RigForOutput(rig, out.log), rig_folder);
  WriteTruthTrajectory(plan.motion, rig.body_from_imu, DriveEpoch(seed), truth / "truth.tum");
  WritePly(DrivableSurface(scene.place), truth / "ground_truth.ply");
  nlohmann::json summary = Summary(options, plan, records, images);
  const double num_images = static_cast<double>(std::max<size_t>(1, images.num_images));
  summary["timings"] = {{"scene_s", scene_seconds},
                        {"drive_s", watch.Lap()},
                        {"render_s_per_image", images.render_seconds / num_images},
                        {"encode_s_per_image", images.encode_seconds / num_images}};
  WriteFileAtomically(truth / "summary.json", summary.dump(2) + "\n");
  return summary;
}

}  // namespace parkade::simulator

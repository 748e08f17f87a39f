#include "tests/simulator/drives/record_drive.h"

#include <algorithm>
#include <chrono>

#include "tests/simulator/common/drive_clock.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/faults/faulty_sink.h"
#include "tests/simulator/render/lens_cover.h"
#include "tests/simulator/render/lens_dirt.h"

namespace parkade::simulator {
namespace {

constexpr double kImageMargin =
    0.1;  // [s] without images at both ends, so that every exposure lies within the motion

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

/// Hands over the records up to `time`, merged in order of time.
class RecordFeeder {
 public:
  RecordFeeder(const SensorRecords& records, DriveSink& sink) : records_(records), sink_(sink) {}

  void FeedUntil(Timestamp time) {
    while (true) {
      const Timestamp imu = TimeAt(records_.imu, next_imu_),
                      wheels = TimeAt(records_.wheels, next_wheels_),
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

/// One camera from lens to file.
struct CameraChain {
  LensDirt dirt;
  CoveredLens lens;
  ImageSensor sensor;
};

std::vector<CameraChain> MakeCameras(const SimulateOptions& options, const Rig& rig) {
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  std::vector<CameraChain> cameras;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const cv::Size size(rig.cameras[camera].model.width(), rig.cameras[camera].model.height());
    cameras.push_back({LensDirt(options.lens.dirt, size, Mix64(seed) + camera),
                       CoveredLens(options.faults, camera, size, seed),
                       ImageSensor(options.image, Mix64(seed) + camera)});
  }
  return cameras;
}

/// The image to take, by the knocked camera where its mirror was hit before.
Shot ShotOf(const SimulateOptions& options, const Motion& motion, const ScheduledFrame& frame,
            size_t num_cameras) {
  const double since_start = frame.time - DriveEpoch(static_cast<std::uint64_t>(options.seed));
  const MirrorMove& mirror = options.faults.mirror;
  const bool is_knocked = mirror.angle_deg != 0 &&
                          static_cast<size_t>(mirror.camera) == frame.camera &&
                          since_start >= mirror.at;
  Shot shot;
  shot.camera = is_knocked ? num_cameras : frame.camera;
  shot.world_from_body = [&motion, since_start](double offset) {
    return motion.WorldFromBody(since_start + offset);
  };
  shot.exposure = options.image.exposure;
  shot.flare = options.lens.flare;
  shot.time = since_start;
  if (options.semantic)
    shot.semantics = options.semantic_kind == "classes" ? Semantics::kClasses
                     : options.semantic_kind == "level" ? Semantics::kLevelGround
                                                        : Semantics::kDrivable;
  return shot;
}

}  // namespace

SensorRecords SimulateSensors(const SimulateOptions& options, const Motion& motion, const Rig& rig,
                              const RoofQuery& is_covered) {
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  std::vector<WheelSlip> slips;
  const StrongSlip& slip = options.faults.slip;
  if (slip.end > slip.begin) slips.push_back({slip.begin, slip.end, slip.ratio});
  SensorRecords records;
  records.imu = SimulateImu(motion, rig, options.sensors, seed);
  if (options.sensors.has_wheels)
    records.wheels = SimulateWheels(motion, options.sensors, seed, slips);
  records.gnss = SimulateGnss(motion, rig, SimulatedDatum(), options.sensors, seed, is_covered);
  return records;
}

Recording RecordDrive(const SimulateOptions& options, const Motion& motion, const Rig& rig,
                      const Renderer& renderer, const SensorRecords& records, DriveSink& sink,
                      const ProgressListener& progress) {
  const std::uint64_t seed = static_cast<std::uint64_t>(options.seed);
  const Timestamp epoch = DriveEpoch(seed);
  std::vector<CameraChain> cameras = MakeCameras(options, rig);
  FaultySink faulty(sink, options.faults, epoch, seed);
  RecordFeeder feeder(records, faulty);
  Recording recording;
  DriveCounts& counts = recording.counts;
  counts.imu = records.imu.size(), counts.wheels = records.wheels.size(),
  counts.gnss = records.gnss.size();
  const StrongSlip& slip = options.faults.slip;
  for (const WheelSample& sample : records.wheels)
    if (slip.begin <= sample.time - epoch && sample.time - epoch < slip.end)
      ++counts.faults["slip.wheels"];
  const auto frames =
      ScheduleFrames(motion, rig.cameras.size(), options.cameras, kImageMargin, seed);
  Stopwatch watch;
  for (const ScheduledFrame& frame : frames) {
    feeder.FeedUntil(frame.time);
    const Shot shot = ShotOf(options, motion, frame, rig.cameras.size());
    watch.Lap();
    RenderedImage rendered = renderer.Render(shot);
    recording.times.render += watch.Lap();
    CameraChain& camera = cameras[frame.camera];
    camera.dirt.Apply(rendered.radiance);
    if (const std::string fault = camera.lens.Apply(rendered.radiance, frame.time - epoch);
        !fault.empty())
      ++counts.faults[fault + "." + rig.cameras[frame.camera].name];
    if (shot.camera != frame.camera) ++counts.faults["mirror." + rig.cameras[frame.camera].name];
    const std::vector<std::uint8_t> jpeg =
        EncodeJpeg(camera.sensor.Develop(rendered.radiance), options.image.jpeg_quality);
    faulty.WriteImage(frame.camera, frame.time, jpeg);
    if (options.semantic) faulty.WriteSemantic(frame.camera, frame.time, EncodePng(rendered.mask));
    recording.times.encode += watch.Lap();
    counts.image_bytes += jpeg.size();
    progress("render", static_cast<double>(++counts.images) / static_cast<double>(frames.size()));
  }
  feeder.FeedAll();
  faulty.Close();
  counts.faults.insert(faulty.counts().begin(), faulty.counts().end());
  return recording;
}

}  // namespace parkade::simulator

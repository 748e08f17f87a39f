#include "tests/simulator/tracks/track_drive.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/error.h"
#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/drives/record_drive.h"
#include "tests/simulator/faults/faulty_rig.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/scenes/scene.h"
#include "tests/simulator/scenes/traffic.h"
#include "tests/simulator/tracks/track_crossing.h"

namespace parkade::simulator {
namespace {

constexpr double kImageMargin = 0.1;     // [s] without images at both ends, as SimulateDrive
constexpr double kGroundTexel = 0.2;     // [m] colors are not looked at
constexpr double kTruthInterval = 0.01;  // [s]

SceneOptions SceneOf(const SimulateOptions& drive) {
  SceneOptions scene = drive.OfScene();
  scene.ground_texel = kGroundTexel;
  return scene;
}

std::uint64_t SeedOf(const TrackDriveOptions& options) {
  return static_cast<std::uint64_t>(options.drive.seed);
}

/// The cameras of one drive and what they look at.
class ImageTaker {
 public:
  ImageTaker(const TrackDriveOptions& options, const OdometryOptions& odometry, const Scene& scene,
             const Motion& motion, TrackDrive& drive)
      : options_(options),
        seed_(SeedOf(options)),
        epoch_(DriveEpoch(seed_)),
        motion_(motion),
        world_(scene),
        drive_(drive),
        crossing_(world_, options.model, odometry.cross_camera, seed_) {
    for (RigCamera& camera : drive_.true_rig.cameras)
      camera.mask = world_.OwnCarMask(camera, kHalfFieldOfView);
    knocked_ = drive_.true_rig.cameras;
    const MirrorMove& mirror = options.drive.faults.mirror;
    const auto moved = static_cast<size_t>(mirror.camera);
    if (mirror.angle_deg != 0 && moved < knocked_.size())
      knocked_[moved] = KnockedCamera(knocked_[moved], mirror.angle_deg);
    for (size_t camera = 0; camera < knocked_.size(); ++camera)
      drive_.rig.cameras[camera].mask = drive_.true_rig.cameras[camera].mask;
    eyes_.reserve(knocked_.size());
    simulators_.reserve(knocked_.size());
    for (size_t camera = 0; camera < knocked_.size(); ++camera) {
      eyes_.emplace_back(motion_, epoch_, drive_.true_rig.cameras[camera]);
      simulators_.emplace_back(eyes_[camera], drive_.rig.cameras[camera], static_cast<int>(camera),
                               world_, options.model, seed_, odometry.tracker);
    }
    if (odometry.match_across_cameras)
      for (const CameraPair& pair : OverlappingPairs(drive_.rig)) pairs_.push_back({pair, {}, {}});
    before_.resize(knocked_.size());
  }

  void TakeAll() {
    const auto start = std::chrono::steady_clock::now();
    for (const ScheduledFrame& frame :
         ScheduleFrames(motion_, knocked_.size(), options_.drive.cameras, kImageMargin, seed_))
      if (frame.time - epoch_ >= options_.begin) Take(frame);
    drive_.seconds_per_image =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() /
        static_cast<double>(std::max<size_t>(1, drive_.images.size()));
    std::stable_sort(
        drive_.images.begin(), drive_.images.end(),
        [](const SeenImage& a, const SeenImage& b) { return a.frame.time < b.frame.time; });
  }

 private:
  bool IsMissing(size_t camera, double time) const {
    const ImageGap& gap = options_.drive.faults.image_gap;
    return (gap.camera < 0 || static_cast<size_t>(gap.camera) == camera) && gap.begin <= time &&
           time < gap.end;
  }

  /// Mud is taken for darkness: what little shows through is not modeled.
  bool IsDark(size_t camera, double time) const {
    const Occlusion& occlusion = options_.drive.faults.occlusion;
    return options_.drive.faults.darkness.Contains(time) ||
           (static_cast<size_t>(occlusion.camera) == camera && occlusion.begin <= time &&
            time < occlusion.end);
  }

  void Take(const ScheduledFrame& frame) {
    const double time = frame.time - epoch_;
    if (IsMissing(frame.camera, time)) return;
    // The rig that is handed out says 0: stamps are wrong by the whole offset.
    const Timestamp stamp = frame.time - drive_.true_rig.cameras[frame.camera].time_shift;
    TrackSimulator& simulator = simulators_[frame.camera];
    const MirrorMove& mirror = options_.drive.faults.mirror;
    if (mirror.angle_deg != 0 && static_cast<size_t>(mirror.camera) == frame.camera &&
        time >= mirror.at)
      eyes_[frame.camera].MountAs(knocked_[frame.camera]);
    const bool is_dark = IsDark(frame.camera, time);
    SeenImage image;
    image.frame = is_dark ? simulator.Miss(stamp) : simulator.Track(frame.time, stamp);
    drive_.images.push_back(std::move(image));
    if (!is_dark) Cross(frame);
  }

  struct Waiting {
    Timestamp time;
    size_t image = 0;
  };

  /// Two cameras, and the images of the second since the last of the first.
  struct OpenPair {
    CameraPair cameras;
    std::vector<Waiting> waiting;
    std::optional<Timestamp> last_match;  ///< of the second
  };

  /// Each image of the second camera is matched with that of the first which is nearest in time,
  /// before or after.
  void Cross(const ScheduledFrame& frame) {
    const TrackedView now{frame.time, simulators_[frame.camera].tracks()};
    TrackedView& last = before_[frame.camera];
    for (OpenPair& pair : pairs_) {
      if (pair.cameras.to == frame.camera)
        pair.waiting.push_back({frame.time, drive_.images.size() - 1});
      if (pair.cameras.from != frame.camera) continue;
      for (const Waiting& other : pair.waiting)
        MatchImages(pair, other.time - last.time < frame.time - other.time ? last : now, other);
      pair.waiting.clear();
    }
    last = now;
  }

  void MatchImages(OpenPair& pair, const TrackedView& from, const Waiting& to) {
    const double apart = std::abs(from.time - to.time);
    if (apart >= kMaxPairTime || (pair.last_match && to.time - *pair.last_match < kMatchInterval))
      return;
    pair.last_match = to.time;
    SeenImage& image = drive_.images[to.image];
    const auto matches = crossing_.Match(simulators_[pair.cameras.from], from,
                                         simulators_[pair.cameras.to], to.time);
    image.crossed.insert(image.crossed.end(), matches.begin(), matches.end());
    image.pair_seconds = std::max(image.pair_seconds, apart);
  }

  const TrackDriveOptions& options_;
  std::uint64_t seed_;
  Timestamp epoch_;
  const Motion& motion_;
  TrackWorld world_;
  TrackDrive& drive_;
  TrackCrossing crossing_;
  std::vector<RigCamera> knocked_;  ///< as mounted after the mirror was moved
  std::vector<TrackEye> eyes_;
  std::vector<TrackSimulator> simulators_;
  std::vector<OpenPair> pairs_;
  std::vector<TrackedView> before_;  ///< the last image per camera
};

void RecordSamples(const TrackDriveOptions& options, const Motion& motion,
                   const RoofQuery& is_covered, TrackDrive& drive) {
  const Timestamp epoch = DriveEpoch(SeedOf(options));
  SensorRecords records = SimulateSensors(options.drive, motion, drive.true_rig, is_covered);
  drive.imu = std::move(records.imu);
  drive.wheels = std::move(records.wheels);
  const auto is_out = [&](const auto& sample, const TimeWindow& gap) {
    return sample.time - epoch < options.begin || gap.Contains(sample.time - epoch);
  };
  std::erase_if(drive.imu, [&](const ImuSample& sample) {
    return is_out(sample, options.drive.faults.imu_gap);
  });
  std::erase_if(drive.wheels, [&](const WheelSample& sample) {
    return is_out(sample, options.drive.faults.wheel_gap);
  });
  // To beyond the last sample: the motion stands still after its end.
  for (double time = options.begin; time < motion.Duration() + kTruthInterval;
       time += kTruthInterval) {
    drive.truth.push_back({epoch + time, motion.WorldFromBody(time)});
    if (drive.truth.size() < 2) continue;
    const TimedPose& last = drive.truth[drive.truth.size() - 2];
    drive.length +=
        (drive.truth.back().world_from_frame.translation - last.world_from_frame.translation)
            .norm();
  }
}

}  // namespace

void TrackDriveOptions::Validate() const {
  drive.Validate();
  const FaultOptions& faults = drive.faults;
  Require(begin >= 0 && begin + 5 <= drive.duration, ErrorCode::kUsage,
          "at least 5 s of the drive must be recorded");
  const bool has_recorder_faults = faults.time_jump.end > faults.time_jump.begin ||
                                   faults.duplicates > 0 || faults.unordered > 0 ||
                                   faults.corrupt_jpegs > 0;
  Require(!has_recorder_faults, ErrorCode::kUsage, "track mode has no faults of recorders");
  model.Validate();
}

TrackDrive MakeTrackDrive(const TrackDriveOptions& options, const OdometryOptions& odometry) {
  options.Validate();
  const SimulateOptions& planned = options.drive;
  const std::uint64_t seed = SeedOf(options);
  TrackDriveOptions recorded = options;
  if (options.noise_seed >= 0) recorded.drive.seed = options.noise_seed;
  Scene scene = BuildScene(planned.scene, SceneOf(planned));
  const DrivePlan plan = PlanDrive(scene.place, planned.drive, planned.duration, seed);
  AddTraffic(scene, plan.motion, planned.traffic, seed);
  TrackDrive drive;
  drive.true_rig = TrueRig(MakeSimulatedRig(planned.rig, seed), planned.faults);
  drive.true_rig.imu = CalibrationOf(ImuGradeNamed(planned.sensors.imu), planned.sensors.imu_rate,
                                     drive.true_rig.imu.topic);
  drive.rig = NominalRig(drive.true_rig, planned.faults, SeedOf(recorded));
  RecordSamples(recorded, plan.motion, scene.place.is_covered, drive);
  ImageTaker(recorded, odometry, scene, plan.motion, drive).TakeAll();
  if (drive.wheels.empty()) drive.rig.vehicle->wheel_topic.clear();
  return drive;
}

double FindMovingStart(const TrackDriveOptions& options, bool is_turning) {
  const Place place = PlanPlace(options.drive.scene, SceneOf(options.drive));
  const DrivePlan plan =
      PlanDrive(place, options.drive.drive, options.drive.duration, SeedOf(options));
  for (double time = 0; time < options.drive.duration / 2; time += 0.1) {
    const MotionState state = plan.motion.At(time);
    const double yaw_rate = std::abs(state.angular_velocity_in_body.z());
    if (state.velocity_in_world.norm() > 2 && (is_turning ? yaw_rate > 0.2 : yaw_rate < 0.05))
      return time;
  }
  return 0;
}

}  // namespace parkade::simulator

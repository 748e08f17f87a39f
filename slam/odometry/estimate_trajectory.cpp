#include "slam/odometry/estimate_trajectory.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <unordered_map>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "slam/odometry/trajectory_estimator.h"
#include "slam/odometry/wheel_agreement.h"

namespace parkade {
namespace {

constexpr double kBatch = 0.2;        // [s] of the log handled at a time
constexpr double kMinOverlap = 0.05;  // of two cameras' views that is worth matching
constexpr double kMaxPairTime =
    0.06;  // [s] between two images that are matched across cameras: any, at 10 Hz
constexpr double kSameTime = 1e-3;  // [s] within which no motion needs to be known
constexpr double kMatchInterval =
    0.07;  // [s] between two images of a camera in which another's tracks are sought
constexpr int kMissesPerTry =
    4;  // images after which a track is sought again that the other camera did not show

constexpr int kCamerasOfAllTracks = 3;  // that follow as many corners as one alone would
constexpr int kFewestTracks = 20;       // of a camera

using Batch = std::vector<SensorRecord>;

struct CameraPair {
  int from = 0, to = 0;
  std::optional<Timestamp> last_match;  // of the image of `to`
  std::unordered_map<std::int64_t, int>
      misses;  // per track of `from`: images since it was sought in vain
};

/// Many cameras need fewer corners each: together they follow what three may.
FeatureTrackerOptions ShareTracks(FeatureTrackerOptions options, size_t num_cameras) {
  const auto count = static_cast<int>(num_cameras);
  if (count > kCamerasOfAllTracks)
    options.max_tracks = std::max(kFewestTracks, options.max_tracks * kCamerasOfAllTracks / count);
  return options;
}

/// Tracks the images of all cameras, batch by batch.
class FrontEnd {
 public:
  FrontEnd(const Rig& rig, const OdometryOptions& options) : options_(options) {
    const FeatureTrackerOptions tracker = ShareTracks(options.tracker, rig.cameras.size());
    for (size_t c = 0; c < rig.cameras.size(); ++c) {
      trackers_.push_back(
          std::make_unique<FeatureTracker>(rig.cameras[c], static_cast<int>(c), tracker));
      last_times_.emplace_back();
    }
    if (!options.match_across_cameras) return;
    for (size_t a = 0; a < rig.cameras.size(); ++a)
      for (size_t b = a + 1; b < rig.cameras.size(); ++b)
        if (ViewOverlap(rig.cameras[a], rig.cameras[b], options.cross_camera.min_depth) >
            kMinOverlap)
          pairs_.push_back({static_cast<int>(a), static_cast<int>(b), {}, {}});
  }

  size_t num_cameras() const { return trackers_.size(); }
  const FeatureTracker& tracker(size_t camera) const { return *trackers_[camera]; }

  /// Takes in the IMU of the batch and what the estimator knows, before the cameras are tracked.
  void Prepare(const Batch& batch, const std::optional<MotionState>& latest,
               std::vector<Rigid3> imu_from_cameras) {
    imu_from_cameras_ = std::move(imu_from_cameras);
    frames_.assign(num_cameras(), {});
    images_.assign(num_cameras(), {});
    latest_ = latest;
    for (const SensorRecord& record : batch)
      if (const auto* sample = std::get_if<ImuSample>(&record))
        if (sample->angular_velocity.allFinite()) imu_.Add(*sample);
    if (!imu_.empty()) imu_.DropBefore(imu_.back().time - 3.0);
  }

  /// Tracks the images of one camera; cameras may run in parallel.
  void TrackCamera(const Batch& batch, size_t camera) {
    for (const SensorRecord& record : batch) {
      const auto* frame = std::get_if<CameraFrame>(&record);
      if (!frame || frame->camera != static_cast<int>(camera)) continue;
      std::optional<Timestamp>& last = last_times_[camera];
      const Eigen::Matrix3d rotation =
          last ? CameraRotation(camera, *last, frame->time) : Eigen::Matrix3d::Identity();
      last = frame->time;
      frames_[camera].push_back(trackers_[camera]->Track(*frame, rotation));
      if (!pairs_.empty()) images_[camera].push_back(trackers_[camera]->last_image());
    }
  }

  /// Looks for tracks of one camera in another's images. Pairs may run in parallel:
  /// they find in images, and add to them one after the other.
  void MatchAcrossCameras() {
    const auto found = ParallelMap(pairs_.size(), [&](size_t i) { return MatchPair(pairs_[i]); });
    for (size_t i = 0; i < pairs_.size(); ++i)
      for (const CrossMatches& matches : found[i]) {
        auto& observations = frames_[static_cast<size_t>(pairs_[i].to)][matches.frame].observations;
        observations.insert(observations.end(), matches.observations.begin(),
                            matches.observations.end());
      }
  }

  /// The tracked frames of the batch in the order of its records.
  std::vector<TrackedFrame> TakeFrames() {
    std::vector<TrackedFrame> all;
    for (auto& frames : frames_)
      for (TrackedFrame& frame : frames) all.push_back(std::move(frame));
    std::stable_sort(all.begin(), all.end(),
                     [](const TrackedFrame& a, const TrackedFrame& b) { return a.time < b.time; });
    return all;
  }

 private:
  /// Another camera's tracks, as an image shows them.
  struct CrossMatches {
    size_t frame = 0;  ///< index into frames_ of the camera
    std::vector<FeatureObservation> observations;
  };

  std::vector<CrossMatches> MatchPair(CameraPair& pair) const {
    const auto& from_images = images_[static_cast<size_t>(pair.from)];
    const auto& to_images = images_[static_cast<size_t>(pair.to)];
    std::vector<CrossMatches> found;
    for (size_t i = 0; i < to_images.size(); ++i) {
      const TrackedImage& to = to_images[i];
      if (to.empty() || to.time != frames_[static_cast<size_t>(pair.to)][i].time) continue;
      if (pair.last_match && to.time - *pair.last_match < kMatchInterval) continue;
      const auto nearest =
          std::min_element(from_images.begin(), from_images.end(),
                           [&](const TrackedImage& a, const TrackedImage& b) {
                             return std::abs(a.time - to.time) < std::abs(b.time - to.time);
                           });
      if (nearest == from_images.end() || nearest->empty()) continue;
      if (std::abs(nearest->time - to.time) >= (latest_ ? kMaxPairTime : kSameTime)) continue;
      pair.last_match = to.time;
      found.push_back({i, MatchImages(pair, *nearest, to)});
    }
    return found;
  }

  /// Tracks sought in vain rest for some images: most of them are in no other camera's view.
  std::vector<FeatureObservation> MatchImages(CameraPair& pair, const TrackedImage& from,
                                              const TrackedImage& to) const {
    std::unordered_map<std::int64_t, int> misses;
    TrackedImage sought = from;
    sought.observations.clear();
    for (const FeatureObservation& seen : from.observations) {
      const auto known = pair.misses.find(seen.track);
      const int count = known == pair.misses.end() ? 0 : known->second;
      misses[seen.track] = count % kMissesPerTry + 1;
      if (count % kMissesPerTry == 0) sought.observations.push_back(seen);
    }
    std::vector<FeatureObservation> matches =
        MatchAcross(sought, to, CameraMotion(from, to), options_.cross_camera);
    for (const FeatureObservation& match : matches) misses.erase(match.track);
    pair.misses = std::move(misses);
    return matches;
  }

  Eigen::Quaterniond ImuRotation(Timestamp begin, Timestamp end) const {
    if (imu_.empty() || !(begin < end)) return Eigen::Quaterniond::Identity();
    const ImuBias bias{latest_ ? latest_->gyroscope_bias : Eigen::Vector3d::Zero(),
                       Eigen::Vector3d::Zero()};
    return Integrate(imu_.Between(begin, end), bias).rotation;
  }

  /// p_now = R p_last.
  Eigen::Matrix3d CameraRotation(size_t camera, Timestamp last, Timestamp now) const {
    const Eigen::Quaterniond imu_from_camera = imu_from_cameras_[camera].rotation;
    return (imu_from_camera.conjugate() * ImuRotation(last, now).conjugate() * imu_from_camera)
        .toRotationMatrix();
  }

  /// to_from_from of two cameras at their own times.
  Rigid3 CameraMotion(const TrackedImage& from, const TrackedImage& to) const {
    Rigid3 imu_to_from_imu_from;
    if (from.time != to.time) {
      const Eigen::Quaterniond rotation = from.time < to.time
                                              ? ImuRotation(from.time, to.time).conjugate()
                                              : ImuRotation(to.time, from.time);
      const Eigen::Vector3d velocity =
          latest_ ? Eigen::Vector3d(latest_->odom_from_imu.rotation.conjugate() *
                                    latest_->velocity_in_odom)
                  : Eigen::Vector3d::Zero();
      imu_to_from_imu_from = {rotation, -(rotation * (velocity * (to.time - from.time)))};
    }
    return imu_from_cameras_[static_cast<size_t>(to.camera)].Inverse() * imu_to_from_imu_from *
           imu_from_cameras_[static_cast<size_t>(from.camera)];
  }

  const OdometryOptions& options_;
  std::vector<std::unique_ptr<FeatureTracker>> trackers_;
  std::vector<CameraPair> pairs_;
  std::vector<std::optional<Timestamp>> last_times_;  // per camera
  ImuBuffer imu_;
  std::optional<MotionState> latest_;
  std::vector<Rigid3> imu_from_cameras_;           // as the estimator knows them by now
  std::vector<std::vector<TrackedFrame>> frames_;  // per camera, of this batch
  std::vector<std::vector<TrackedImage>> images_;  // per camera, of this batch
};

/// What the estimator gets of one batch: images already tracked.
struct TrackedBatch {
  std::vector<SensorRecord> samples;  // no images among them
  std::vector<TrackedFrame> frames;
};

Batch ReadBatch(RecordStream& stream, std::optional<SensorRecord>& ahead) {
  Batch batch;
  if (!ahead) ahead = stream.Next();
  if (!ahead) return batch;
  const Timestamp end = TimeOf(*ahead) + kBatch;
  while (ahead && TimeOf(*ahead) < end) {
    batch.push_back(std::move(*ahead));
    ahead = stream.Next();
  }
  return batch;
}

void Feed(TrackedBatch& batch, TrajectoryEstimator& estimator) {
  size_t next = 0;
  for (const SensorRecord& record : batch.samples) {
    for (; next < batch.frames.size() && batch.frames[next].time <= TimeOf(record); ++next)
      estimator.Add(std::move(batch.frames[next]));
    if (const auto* imu = std::get_if<ImuSample>(&record)) estimator.Add(*imu);
    if (const auto* wheel = std::get_if<WheelSample>(&record)) estimator.Add(*wheel);
  }
  for (; next < batch.frames.size(); ++next) estimator.Add(std::move(batch.frames[next]));
}

/// One pass over the log, with the wheels or without.
OdometryResult EstimateOnce(const DriveLog& log, const OdometryOptions& options,
                            const ProgressCallback& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const Rig& rig = log.rig();
  FrontEnd front_end(rig, options);
  TrajectoryEstimator estimator(rig, options);
  ReadOptions read_options;
  read_options.gnss = false;
  const std::unique_ptr<RecordStream> stream = log.Read(read_options);
  std::optional<SensorRecord> ahead;
  TrackedBatch tracked;  // of the batch before: the estimator works on it while cameras are tracked
  for (Batch batch; !(batch = ReadBatch(*stream, ahead)).empty();) {
    front_end.Prepare(batch, estimator.Latest(), estimator.ImuFromCameras());
    ParallelFor(front_end.num_cameras() + 1, [&](size_t task) {
      if (task == 0)
        Feed(tracked, estimator);
      else
        front_end.TrackCamera(batch, task - 1);
    });
    front_end.MatchAcrossCameras();
    tracked = {{}, front_end.TakeFrames()};
    for (SensorRecord& record : batch)
      if (!std::holds_alternative<CameraFrame>(record))
        tracked.samples.push_back(std::move(record));
    const double span = log.span().Seconds();
    if (progress && span > 0 && ahead)
      progress(std::clamp((TimeOf(*ahead) - log.span().begin) / span, 0.0, 1.0));
  }
  Feed(tracked, estimator);
  OdometryResult result = estimator.Finish();
  for (size_t c = 0; c < front_end.num_cameras(); ++c) {
    const FeatureTrackerStatistics& statistics = front_end.tracker(c).statistics();
    result.report.cameras[c].frames_rejected =
        statistics.frames_wrong_size + statistics.frames_blank + statistics.frames_duplicate;
  }
  result.report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (progress) progress(1.0);
  LogInfo("stage=odometry nodes=" + std::to_string(result.report.nodes) +
          " length=" + std::to_string(result.report.length) +
          " seconds=" + std::to_string(result.report.seconds));
  return result;
}

std::vector<WheelSample> ReadWheels(const DriveLog& log) {
  ReadOptions only_wheels;
  only_wheels.imu = only_wheels.gnss = only_wheels.images = false;
  const std::unique_ptr<RecordStream> stream = log.Read(only_wheels);
  std::vector<WheelSample> wheels;
  while (const std::optional<SensorRecord> record = stream->Next())
    if (const auto* sample = std::get_if<WheelSample>(&*record)) wheels.push_back(*sample);
  return wheels;
}

/// The trajectory with wheels; nothing where it takes none, or where no start was found with them.
std::optional<OdometryResult> EstimateWithWheels(const DriveLog& log,
                                                 const OdometryOptions& options,
                                                 const ProgressCallback& progress,
                                                 std::optional<Error>& error) {
  try {
    return EstimateOnce(log, options, progress);
  } catch (const Error& thrown) {
    if (thrown.code() != ErrorCode::kInvalidInput) throw;
    error = thrown;
    return std::nullopt;
  }
}

}  // namespace

OdometryResult EstimateTrajectory(const DriveLog& log, const OdometryOptions& options,
                                  const ProgressCallback& progress) {
  options.Validate();
  if (!options.use_wheels) return EstimateOnce(log, options, progress);
  std::optional<Error> error;
  std::optional<OdometryResult> with = EstimateWithWheels(log, options, progress, error);
  if (with && !with->report.has_wheels) return std::move(*with);
  const std::vector<WheelSample> wheels = ReadWheels(log);
  if (with && CompareWheels(with->odom_from_body, wheels).Fits()) return std::move(*with);
  if (!with && wheels.empty()) throw Error(*error);

  // Wheels that contradict the rest spoil what they are fused with: only without them can be said
  // who is wrong.
  OdometryOptions no_wheels = options;
  no_wheels.use_wheels = false;
  std::optional<Error> second_error;
  std::optional<OdometryResult> without =
      EstimateWithWheels(log, no_wheels, progress, second_error);
  if (!without && with) return std::move(*with);
  if (!without) throw Error(*error);
  const WheelAgreement agreement = CompareWheels(without->odom_from_body, wheels);
  if (with && agreement.Fits()) return std::move(*with);
  without->report.wheels_left_out =
      agreement.Fits() ? "prevent a start that succeeds without them" : agreement.Doubt();
  return std::move(*without);
}

}  // namespace parkade

#include "slam/places/describe_keyframes.h"

#include <map>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/math/decompositions.h"
#include "core/parallel.h"
#include "slam/places/cylinder_view.h"
#include "slam/places/ground_bev.h"

namespace parkade {
namespace {

constexpr size_t kImagesPerBatch = 16;
constexpr int kCell = 32;  // [px] corners are spread over cells of this size
constexpr int kCornersPerCell = 6;
constexpr double kPixelSigma = 0.7;  // [px] of a corner at full size
constexpr double kOctave = 1.2;      // from one size at which corners are looked for to the next
constexpr double kCoarsest = 40;     // [px/rad] at which any camera's corners are looked for
constexpr int kMinOctaves = 6, kMaxOctaves = 16;
constexpr int kViewWidth = 200;         // [px] of a keyframe's images for people
constexpr double kMaxImageDelay = 0.5;  // [s] an image may come after the moment of its keyframe

/// Accepts each camera's first image after the moment of each keyframe that is to be described.
class ImagePicker {
 public:
  ImagePicker(const std::vector<RigKeyframe>& keyframes, const std::vector<bool>& is_wanted,
              size_t num_cameras)
      : keyframes_(keyframes), is_wanted_(is_wanted), next_(num_cameras, 0) {}

  bool Wants(int camera, Timestamp time) {
    size_t& next = next_[static_cast<size_t>(camera)];
    if (next == keyframes_.size() || time < keyframes_[next].time) return false;
    while (next < keyframes_.size() && keyframes_[next].time <= time) ++next;
    return is_wanted_[next - 1] && time - keyframes_[next - 1].time < kMaxImageDelay;
  }

 private:
  const std::vector<RigKeyframe>& keyframes_;
  const std::vector<bool>& is_wanted_;
  std::vector<size_t> next_;  ///< per camera
};

/// The strongest corners, not more than a few per cell.
std::vector<cv::KeyPoint> Spread(std::vector<cv::KeyPoint> corners, int max_count) {
  std::stable_sort(
      corners.begin(), corners.end(),
      [](const cv::KeyPoint& a, const cv::KeyPoint& b) { return a.response > b.response; });
  std::map<std::pair<int, int>, int> taken;
  std::vector<cv::KeyPoint> spread;
  for (const cv::KeyPoint& corner : corners) {
    if (static_cast<int>(spread.size()) == max_count) break;
    int& count =
        taken[{static_cast<int>(corner.pt.x) / kCell, static_cast<int>(corner.pt.y) / kCell}];
    if (count++ < kCornersPerCell) spread.push_back(corner);
  }
  return spread;
}

/// Half of them, where there are so many, from octave `shared` on.
std::vector<cv::KeyPoint> SpreadOverSizes(std::vector<cv::KeyPoint> corners, int shared,
                                          int max_count) {
  if (shared <= 0) return Spread(std::move(corners), max_count);
  const auto begin =
      std::stable_partition(corners.begin(), corners.end(),
                            [&](const cv::KeyPoint& corner) { return corner.octave >= shared; });
  std::vector<cv::KeyPoint> chosen = Spread({corners.begin(), begin}, max_count / 2);
  const std::vector<cv::KeyPoint> finer =
      Spread({begin, corners.end()}, max_count - static_cast<int>(chosen.size()));
  chosen.insert(chosen.end(), finer.begin(), finer.end());
  return chosen;
}

/// What one image adds to its keyframe.
struct DescribedImage {
  size_t keyframe = 0;
  int camera = 0;
  Timestamp time;
  std::vector<KeyframeFeature> features;
  cv::Mat descriptors, small;
  GroundBev floor;
};

/// A rotation, the same for a whole drive, after which the body stands upright on average: without
/// vehicle.yaml it is the IMU, which may lie in any way.
Eigen::Quaterniond UprightFromBody(const Trajectory& odom_from_body) {
  Eigen::Vector3d up_in_body = Eigen::Vector3d::Zero();
  for (const TrajectoryState& state : odom_from_body.states())
    up_in_body += state.world_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  return RotationBetween(up_in_body, Eigen::Vector3d::UnitZ());
}

/// Cameras of all resolutions have their coarsest octave in common, so that corners that one of
/// them sees at full size the other one finds at a smaller one.
int NumOctaves(double pixels_per_radian) {
  const double octaves = std::log(pixels_per_radian / kCoarsest) / std::log(kOctave);
  return std::clamp(1 + static_cast<int>(std::lround(octaves)), kMinOctaves, kMaxOctaves);
}

DescribedImage Describe(const CameraFrame& frame, const CylinderView& view,
                        const Rigid3& keyframe_from_body, const Rigid3& body_from_camera,
                        const Eigen::Quaterniond& upright_from_body,
                        const KeyframeOptions& options) {
  const int num_octaves = NumOctaves(view.pixels_per_radian());
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(4 * options.max_features, static_cast<float>(kOctave), num_octaves, 16, 0, 2,
                      cv::ORB::HARRIS_SCORE, 31, /*fastThreshold=*/8);
  const cv::Mat image = view.Warp(frame.image);
  std::vector<cv::KeyPoint> corners;
  orb->detect(image, corners, view.usable());
  corners = SpreadOverSizes(std::move(corners), num_octaves - kMinOctaves, options.max_features);
  DescribedImage described;
  described.camera = frame.camera;
  described.time = frame.time;
  const double scale = static_cast<double>(kViewWidth) / frame.image.cols;
  cv::resize(frame.image, described.small, {}, scale, scale, cv::INTER_AREA);
  orb->compute(image, corners, described.descriptors);
  const Eigen::Vector3d origin = keyframe_from_body * body_from_camera.translation;
  const Eigen::Quaterniond keyframe_from_upright =
      keyframe_from_body.rotation * upright_from_body.conjugate();
  for (const cv::KeyPoint& corner : corners) {
    KeyframeFeature feature;
    feature.camera = frame.camera;
    feature.origin = origin;
    feature.bearing = keyframe_from_upright * view.BearingInUpright(corner.pt.x, corner.pt.y);
    feature.sigma = kPixelSigma * std::pow(kOctave, corner.octave) / view.pixels_per_radian();
    feature.image_point =
        view.ImagePoint(corner.pt.x, corner.pt.y).array() /
        Eigen::Array2f(static_cast<float>(frame.image.cols), static_cast<float>(frame.image.rows));
    described.features.push_back(feature);
  }
  return described;
}

size_t KeyframeAt(const std::vector<RigKeyframe>& keyframes, Timestamp time) {
  const auto after =
      std::upper_bound(keyframes.begin(), keyframes.end(), time,
                       [](Timestamp t, const RigKeyframe& keyframe) { return t < keyframe.time; });
  return static_cast<size_t>(after - keyframes.begin()) - 1;
}

/// Puts images together to keyframes.
class KeyframesInWork {
 public:
  KeyframesInWork(std::vector<RigKeyframe> keyframes, size_t num_cameras,
                  const KeyframeOptions& options, const KeyframeSink& sink)
      : floors_(keyframes.size()),
        num_cameras_(num_cameras),
        queue_(std::move(keyframes), options, sink) {}

  const std::vector<RigKeyframe>& keyframes() const { return queue_.keyframes(); }

  void Add(const DescribedImage& image) {
    RigKeyframe& keyframe = queue_.At(image.keyframe);
    keyframe.features.insert(keyframe.features.end(), image.features.begin(), image.features.end());
    keyframe.descriptors.push_back(image.descriptors);
    keyframe.views.resize(num_cameras_);
    keyframe.views[static_cast<size_t>(image.camera)] = image.small;
    keyframe.image_times.resize(num_cameras_);
    keyframe.image_times[static_cast<size_t>(image.camera)] = image.time;
    if (!image.floor.image.empty()) AddObservation(image.floor, floors_[image.keyframe]);
  }

  /// Keyframes before `end` will get no more images.
  void Finish(size_t end) {
    for (; num_complete_ < end; ++num_complete_)
      queue_.At(num_complete_).floor = ImageOf(std::exchange(floors_[num_complete_], {}));
    queue_.Complete(end);
  }

 private:
  std::vector<GroundBev> floors_;
  size_t num_cameras_;
  TriangulationQueue queue_;
  size_t num_complete_ = 0;
};

}  // namespace

std::vector<RigKeyframe> ChooseKeyframes(const Trajectory& odom_from_body,
                                         const KeyframeOptions& options) {
  options.Validate();
  std::vector<RigKeyframe> keyframes;
  double distance = 0;
  const TrajectoryState* last = nullptr;
  for (const TrajectoryState& state : odom_from_body.states()) {
    if (last)
      distance += (state.world_from_body.translation - last->world_from_body.translation).norm();
    last = &state;
    const Rigid3 pose = LeveledPose(state.world_from_body);
    if (!keyframes.empty()) {
      const double turn =
          keyframes.back().odom_from_keyframe.rotation.angularDistance(pose.rotation);
      if (distance - keyframes.back().distance < options.spacing &&
          turn < options.spacing_deg * M_PI / 180)
        continue;
    }
    keyframes.push_back({state.time, distance, pose, {}, {}});
  }
  return keyframes;
}

void DescribeKeyframes(const DriveLog& log, const Trajectory& odom_from_body,
                       const KeyframeOptions& options, const std::vector<bool>& is_wanted,
                       std::vector<RigKeyframe> chosen, const KeyframeSink& sink) {
  options.Validate();
  const Rig& rig = log.rig();
  const Eigen::Quaterniond upright_from_body = UprightFromBody(odom_from_body);
  const std::vector<CylinderView> views = ParallelMap(rig.cameras.size(), [&](size_t i) {
    return CylinderView(rig.cameras[i], upright_from_body);
  });
  // Without a vehicle it is unknown how far the ground is below the body.
  std::vector<GroundBevView> floors;
  if (rig.vehicle)
    floors =
        ParallelMap(rig.cameras.size(), [&](size_t i) { return GroundBevView(rig.cameras[i]); });
  KeyframesInWork work(std::move(chosen), rig.cameras.size(), options, sink);
  const std::vector<RigKeyframe>& keyframes = work.keyframes();
  ImagePicker picker(keyframes, is_wanted, rig.cameras.size());
  ReadOptions read;
  read.imu = read.wheels = read.gnss = false;
  read.wants_image = [&](int camera, Timestamp time) { return picker.Wants(camera, time); };
  const std::unique_ptr<RecordStream> stream = log.Read(read);
  for (bool is_at_end = false; !is_at_end;) {
    std::vector<CameraFrame> batch;
    while (batch.size() < kImagesPerBatch && !is_at_end) {
      std::optional<SensorRecord> record = stream->Next();
      is_at_end = !record;
      if (!record || !std::holds_alternative<CameraFrame>(*record)) continue;
      auto& frame = std::get<CameraFrame>(*record);
      if (odom_from_body.At(frame.time)) batch.push_back(std::move(frame));
    }
    const std::vector<DescribedImage> described = ParallelMap(batch.size(), [&](size_t i) {
      const CameraFrame& frame = batch[i];
      const auto camera = static_cast<size_t>(frame.camera);
      const size_t keyframe = KeyframeAt(keyframes, frame.time);
      const Rigid3 keyframe_from_body =
          keyframes[keyframe].odom_from_keyframe.Inverse() * *odom_from_body.At(frame.time);
      DescribedImage image =
          Describe(frame, views[camera], keyframe_from_body, rig.cameras[camera].body_from_camera,
                   upright_from_body, options);
      image.keyframe = keyframe;
      if (!floors.empty())
        image.floor = floors[camera].Look(frame.image, keyframe_from_body, frame.camera);
      return image;
    });
    for (const DescribedImage& image : described) work.Add(image);
    if (!described.empty()) work.Finish(described.back().keyframe);  // images come in order of time
  }
  work.Finish(keyframes.size());
}

}  // namespace parkade

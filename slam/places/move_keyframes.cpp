#include "slam/places/move_keyframes.h"

#include <optional>
#include <utility>

namespace parkade {
namespace {

/// An image by both estimates.
struct MovedImage {
  Timestamp time;
  Eigen::Vector3d origin;       ///< [m] of the camera in the keyframe
  Eigen::Quaterniond rotation;  ///< of bearings in the keyframe
};

/// An image that a camera took at `time` by `from`; nothing where there is none, or where it is out
/// of a trajectory's time.
std::optional<MovedImage> MoveImage(const PlacedDrive& from, const PlacedDrive& to, size_t camera,
                                    const RigKeyframe& described, const Rigid3& to_from_keyframe) {
  const Timestamp time = described.image_times[camera];
  const RigCamera &before = from.rig.cameras[camera], &after = to.rig.cameras[camera];
  const Timestamp moved_time = time + (after.time_shift - before.time_shift);
  const std::optional<Rigid3> body_before = from.odom_from_body.At(time),
                              body_after = to.odom_from_body.At(moved_time);
  if (!body_before || !body_after) return std::nullopt;
  const Rigid3 described_from_camera =
                   described.odom_from_keyframe.Inverse() * *body_before * before.body_from_camera,
               moved_from_camera =
                   to_from_keyframe.Inverse() * *body_after * after.body_from_camera;
  return MovedImage{moved_time, moved_from_camera.translation,
                    moved_from_camera.rotation * described_from_camera.rotation.conjugate()};
}

}  // namespace

KeyframeMover::KeyframeMover(const PlacedDrive& from, const PlacedDrive& to,
                             std::vector<RigKeyframe> moved, const KeyframeOptions& options,
                             KeyframeSink sink)
    : from_(from), to_(to), queue_(std::move(moved), options, std::move(sink)) {}

void KeyframeMover::Add(RigKeyframe described) {
  const Rigid3 odom_from_keyframe = queue_.At(num_added_).odom_from_keyframe;
  std::vector<std::optional<MovedImage>> images;
  for (size_t camera = 0; camera < described.image_times.size(); ++camera) {
    images.push_back(MoveImage(from_, to_, camera, described, odom_from_keyframe));
    if (images.back()) described.image_times[camera] = images.back()->time;
  }
  for (KeyframeFeature& feature : described.features) {
    feature.point.reset();
    feature.depth_sigma = 0;
    const std::optional<MovedImage>& image = images[static_cast<size_t>(feature.camera)];
    if (!image) continue;
    feature.origin = image->origin;
    feature.bearing = image->rotation * feature.bearing;
  }
  described.odom_from_keyframe = odom_from_keyframe;
  queue_.At(num_added_++) = std::move(described);
  queue_.Complete(num_added_);
}

}  // namespace parkade

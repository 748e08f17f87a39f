#include "mapping/ground/keyframe_picker.h"

#include <cmath>

namespace parkade {
namespace {

constexpr double kSameImage = 0.002;  // [s] a mask may be stamped this far from its image

}  // namespace

KeyframePicker::KeyframePicker(const Trajectory& odom_from_body, size_t num_cameras, double stretch,
                               double turn, const RepeatedPasses* repeated)
    : odom_from_body_(&odom_from_body),
      repeated_(repeated),
      stretch_(stretch),
      turn_(turn),
      cameras_(num_cameras) {}

bool KeyframePicker::Wants(int camera_index, Timestamp time) {
  Camera& camera = cameras_[static_cast<size_t>(camera_index)];
  if (camera.last && std::abs(time - camera.last->time) < kSameImage) return camera.last->is_chosen;
  if (camera.last && time < camera.last->time) return false;
  const std::optional<Rigid3> pose = odom_from_body_->At(time);
  if (!pose) return false;
  const bool is_repeated = repeated_ && repeated_->Contains(time);
  camera.last = Image{time, *pose, !is_repeated && IsStretchOver(camera, *pose)};
  if (camera.last->is_chosen) camera.last_chosen = camera.last;
  return camera.last->is_chosen;
}

/// As if the next image came as far from this one as this one from the last.
bool KeyframePicker::IsStretchOver(const Camera& camera, const Rigid3& odom_from_body) const {
  if (!camera.last_chosen) return true;
  const auto travel = [&](const Image& image) {
    return (odom_from_body.translation - image.odom_from_body.translation).norm();
  };
  const auto turning = [&](const Image& image) {
    return odom_from_body.rotation.angularDistance(image.odom_from_body.rotation);
  };
  return travel(*camera.last_chosen) + 0.5 * travel(*camera.last) >= stretch_ ||
         turning(*camera.last_chosen) + 0.5 * turning(*camera.last) >= turn_;
}

}  // namespace parkade

#include "mapping/keyframe_picker.h"

#include <cmath>

namespace parkade {
namespace {

constexpr double kSameImage = 0.002;  // [s] a mask may be stamped this far from its image

}  // namespace

KeyframePicker::KeyframePicker(const Trajectory& odom_from_body, size_t num_cameras, double min_distance,
                               double min_angle)
    : odom_from_body_(&odom_from_body),
      min_distance_(min_distance),
      min_angle_(min_angle),
      last_choices_(num_cameras) {}

bool KeyframePicker::Wants(int camera, Timestamp time) {
  std::optional<Choice>& last = last_choices_[static_cast<size_t>(camera)];
  if (last && std::abs(time - last->time) < kSameImage) return true;
  if (last && time < last->time) return false;
  const std::optional<Rigid3> pose = odom_from_body_->At(time);
  if (!pose) return false;
  if (last && (pose->translation - last->odom_from_body.translation).norm() < min_distance_ &&
      pose->rotation.angularDistance(last->odom_from_body.rotation) < min_angle_)
    return false;
  last = Choice{time, *pose};
  return true;
}

}  // namespace parkade

#include "slam/smoother/drive_measurements.h"

#include "slam/smoother/measurement_exchange.h"

namespace parkade {

void DriveMeasurements::AddKnot(const RecordedKnot& knot, const std::optional<KnotInterval>& interval) {
  std::optional<RecordedInterval> recorded;
  if (interval) recorded = {interval->imu.samples(), interval->imu.bias(), interval->wheels, interval->is_still};
  AddKnot(knot, std::move(recorded));
}

void DriveMeasurements::AddKnot(const RecordedKnot& knot, std::optional<RecordedInterval> interval) {
  knots.push_back(knot);
  intervals_.Add(interval);
}

void DriveMeasurements::AddImage(RecordedImage image) { images_.Add(image); }

std::optional<KnotInterval> DriveMeasurements::IntervalBefore(size_t knot) const {
  const std::optional<RecordedInterval> recorded = intervals_[knot];
  if (!recorded) return std::nullopt;
  return KnotInterval{ImuPreintegration(recorded->samples, recorded->bias, imu_), recorded->wheels, recorded->is_still};
}

RecordedImage DriveMeasurements::Image(size_t image) const { return images_[image]; }

}  // namespace parkade

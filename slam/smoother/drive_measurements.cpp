#include "slam/smoother/drive_measurements.h"

#include "slam/smoother/measurement_serialization.h"

namespace parkade {

void DriveMeasurements::AddNode(const RecordedNode& node,
                                const std::optional<NodeInterval>& interval) {
  std::optional<RecordedInterval> recorded;
  if (interval)
    recorded = {interval->imu.samples(), interval->imu.bias(), interval->wheels,
                interval->is_still};
  AddNode(node, std::move(recorded));
}

void DriveMeasurements::AddNode(const RecordedNode& node,
                                std::optional<RecordedInterval> interval) {
  nodes.push_back(node);
  intervals_.Add(interval);
}

void DriveMeasurements::AddImage(RecordedImage image) { images_.Add(image); }

std::optional<NodeInterval> DriveMeasurements::IntervalBefore(size_t node) const {
  const std::optional<RecordedInterval> recorded = intervals_[node];
  if (!recorded) return std::nullopt;
  return NodeInterval{ImuPreintegration(recorded->samples, recorded->bias, imu_), recorded->wheels,
                      recorded->is_still};
}

RecordedImage DriveMeasurements::Image(size_t image) const { return images_[image]; }

}  // namespace parkade

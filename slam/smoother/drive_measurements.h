#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slam/smoother/record_store.h"
#include "slam/smoother/recorded_states.h"
#include "slam/smoother/smoother_window.h"

namespace parkade {

/// Everything the odometry measured, so that the whole drive can be adjusted at once. It lies on
/// disk, where the drive may be as long as it likes; only the nodes' states are in memory.
class DriveMeasurements {
 public:
  explicit DriveMeasurements(const ImuCalibration& imu) : imu_(imu) {}

  /// \param interval  what IMU and wheels say about the way from the node before; empty at the
  /// first
  void AddNode(const RecordedNode& node, const std::optional<NodeInterval>& interval);
  void AddNode(const RecordedNode& node, std::optional<RecordedInterval> interval);
  /// In order of their first node.
  void AddImage(RecordedImage image);

  // From disk, by index. Several threads may read at once.
  std::optional<NodeInterval> IntervalBefore(size_t node) const;
  RecordedImage Image(size_t image) const;
  size_t num_images() const { return images_.size(); }
  // As BinaryWriter encodes std::optional<RecordedInterval> and RecordedImage.
  std::string IntervalBytes(size_t node) const { return intervals_.Bytes(node); }
  std::string ImageBytes(size_t image) const { return images_.Bytes(image); }

  std::vector<RecordedNode>
      nodes;  ///< in order, numbers without gaps; AddNode adds, states may be corrected
  SharedFindings shared;

 private:
  ImuCalibration imu_;
  RecordStore<std::optional<RecordedInterval>> intervals_;
  RecordStore<RecordedImage> images_;
};

}  // namespace parkade

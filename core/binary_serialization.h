#pragma once

#include <opencv2/core/mat.hpp>
#include <utility>
#include <vector>

#include "core/files/binary_archive.h"
#include "core/rigid3.h"
#include "core/timestamp.h"
#include "core/trajectory.h"

// Types that several kinds of files hold, for BinaryWriter and BinaryReader.
namespace parkade {

template <typename Archive>
void Serialize(Archive& archive, Timestamp& time) {
  archive(time.ns);
}

template <typename Archive>
void Serialize(Archive& archive, Rigid3& motion) {
  archive(motion.rotation, motion.translation);
}

template <typename Archive>
void Serialize(Archive& archive, TrajectoryState& state) {
  archive(state.time, state.world_from_body, state.velocity_in_world, state.gyroscope_bias,
          state.accelerometer_bias, state.covariance);
}

template <typename Archive>
void Serialize(Archive& archive, Trajectory& trajectory) {
  std::vector<TrajectoryState> states = trajectory.states();
  archive(states);
  trajectory = Trajectory(std::move(states));
}

/// An image of bytes: CV_8UC1 to CV_8UC4.
template <typename Archive>
void Serialize(Archive& archive, cv::Mat& image) {
  std::int32_t rows = image.rows, columns = image.cols, type = image.type();
  archive(rows, columns, type);
  Require(rows >= 0 && columns >= 0 && CV_MAT_DEPTH(type) == CV_8U, ErrorCode::kInvalidInput,
          "it holds an image that cannot be");
  archive.Count(static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns));
  image.create(rows, columns, type);  // nothing happens where it is so already
  for (int row = 0; row < rows; ++row)
    archive.Raw(image.ptr(row), static_cast<size_t>(columns) * image.elemSize());
}

}  // namespace parkade

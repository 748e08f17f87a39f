#pragma once

#include "core/rigid3.h"

namespace parkade::simulator {

/// A rigid motion in single precision, as a matrix.
struct FastPose {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();

  FastPose() = default;
  explicit FastPose(const Rigid3& motion)
      : rotation(motion.rotation.toRotationMatrix().cast<float>()),
        translation(motion.translation.cast<float>()) {}
  Eigen::Vector3f operator*(const Eigen::Vector3f& point) const {
    return rotation * point + translation;
  }
  Eigen::Vector3f ToSource(const Eigen::Vector3f& point) const {
    return rotation.transpose() * (point - translation);
  }
};

}  // namespace parkade::simulator

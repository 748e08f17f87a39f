#pragma once

#include "core/calibration/yaml_file.h"

namespace parkade {

/// A calibration as Kalibr's files have it.
struct KalibrNodes {
  YamlNode chain, imu;
};

/// What Basalt's calibration (its JSON, which is YAML too) says, in Kalibr's words: lenses `ds`,
/// `eucm`, `ucm`, `kb4`, `pinhole` and `pinhole-radtan8` without a denominator. Biases and
/// non-orthogonal axes of the IMU are left to the estimator. Throws Error{kInvalidInput} naming the
/// key that is missing, or a lens that Parkade does not know.
KalibrNodes FromBasalt(const YamlNode& file);

}  // namespace parkade

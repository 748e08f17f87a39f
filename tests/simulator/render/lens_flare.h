#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/camera_model.h"
#include "tests/simulator/common/color.h"
#include "tests/simulator/rays/sample_table.h"

namespace parkade::simulator {

/// Adds what a lens makes of the sun: a veil that fades with the angle from it, and ghosts on the
/// line through it and the image's middle. Sun and lens face each other, nothing between.
/// \param to_sun    unit, in camera
/// \param sun       irradiance times the strength of the flare
/// \param radiance  CV_32FC3; black stays black
void AddFlare(const Eigen::Vector3f& to_sun, const Color& sun, const CameraModel& model,
              const SampleTable& table, cv::Mat& radiance);

}  // namespace parkade::simulator

#pragma once

#include <string>
#include <vector>

#include "core/camera_model.h"

namespace parkade::simulator {

/// kb (Kannala-Brandt), omni (Mei), eucm, ds (double sphere), ocam (Scaramuzza): the fisheye models
/// of a rig file.
const std::vector<std::string>& LensNames();

/// The lens of another model that is like `lens` to within half a pixel (at 640 pixels' width) over
/// 188 degrees. `name`: one of LensNames().
CameraModel::Projection LensLike(const KannalaBrandtProjection& lens, const std::string& name);

}  // namespace parkade::simulator

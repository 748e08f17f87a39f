#pragma once

#include <filesystem>

#include "core/calibration/yaml_file.h"

namespace parkade {

/// The lens in a calib_results.txt of the OCamCalib toolbox (D. Scaramuzza), with the keys of a
/// camera of the chain (intrinsics, center, affine part, resolution). The file counts rows
/// before columns, as MATLAB does; its polynomial's z points backwards.
///
/// Throws Error{kInvalidInput} naming the file where it is none, or its polynomial has a linear
/// part or a degree above 4, which Parkade's lens cannot hold.
YAML::Node ReadOcamFile(const std::filesystem::path& file);

}  // namespace parkade

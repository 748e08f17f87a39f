#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/geo.h"
#include "core/ground_markings.h"
#include "mapping/evaluation/evaluate_kerbs.h"

namespace parkade {

/// The kerbs of a map's markings.geojson, in its site. Throws Error{kNotFound} without the file,
/// Error{kInvalidInput} where it is no such file.
std::vector<Kerb> ReadKerbs(const std::filesystem::path& file);

/// True kerbs from the LineStrings of `type` "kerb" with `height_m` of a GeoJSON, in meters: as
/// parkade-simulate writes them (`line`, in the truth's world), or with "frame": "site", or, with a
/// datum, in WGS84. Throws Error{kNotFound}, Error{kInvalidInput}.
std::vector<TrueKerb> ReadTrueKerbs(const std::filesystem::path& file,
                                    const std::optional<SiteDatum>& datum);

}  // namespace parkade

#pragma once

#include <filesystem>

#include "core/site_map.h"

namespace parkade {

/// Writes every file of a map that follows from the map alone into an existing folder, each whole
/// or not at all:
///
///   map.glb, map_plain.glb, tileset.json, tiles/*.glb, ground.ply, ortho.png, ortho.pgw
///   free_space.geojson, slots.geojson, markings.geojson
///   <drive>/odometry.tum, <drive>/trajectory.tum, <drive>/covariance.csv
///   <drive>/trajectory.geojson, <drive>/trajectory.kml, ortho.tif   where there is a datum
///
/// Same map and same geoid file (Geoid), same bytes. Throws Error{kInternal} where the map breaks a
/// promise (mesh, names of drives), and what WriteFileAtomically throws.
void WriteSiteMap(const SiteMap& map, const std::filesystem::path& folder);

}  // namespace parkade

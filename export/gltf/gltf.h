#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>

#include "core/site_map.h"
#include "export/gltf/mesh_encoding.h"

namespace parkade {

/// The map as one glTF 2.0 binary (.glb), y up: node `site` with `ground` (the mesh, unlit, a piece
/// with a JPEG per chart of the texture or else vertex colors, and the vertex attribute
/// _HEIGHT_SIGMA [m]) and one `drive:<name>` per drive (a line strip of the final trajectory of the
/// body's origin). Datum and transforms are in `asset.extras`. Valid without a mesh, without
/// drives, and without both. Same map, same bytes.
void WriteGltf(const SiteMap& map, MeshEncoding encoding, std::ostream& stream);

/// One tile: the mesh alone, with its texture or else vertex colors.
std::string EncodeGltfTile(const TriangleMesh& mesh, const GroundTexture& texture = {});

/// What asset.extras says about frames: `gltf_from_site` and, where there is a datum,
/// `georeference`. 4 x 4 matrices are column-major, as everywhere in glTF.
nlohmann::json DescribeFrames(const std::optional<SiteDatum>& datum);

/// 4 x 4 column-major.
std::vector<double> ColumnMajor(const Rigid3& motion);

}  // namespace parkade

#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>

#include "core/geo.h"

namespace parkade {

/// Where a point of the old site lies now [m]; nothing where it is no part of the map any more.
using PointMotion =
    std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector3d& point_in_site)>;

/// A .glb that EncodeGltf wrote with MeshEncoding::kPlain, whose ground and lines of drives have
/// moved: positions, normals and the frames in `extras`; textures and triangles stay. Triangles
/// with a corner that is gone shrink to nothing. Lines of drives other than `drives` are left out.
/// `preview`, where there is one, is said in `asset.extras`. Throws Error{kInvalidInput} for any
/// other file.
std::string MoveGltf(const std::string& glb, const PointMotion& motion,
                     const std::set<std::string>& drives, const std::optional<SiteDatum>& datum,
                     const std::string& preview = "");

}  // namespace parkade

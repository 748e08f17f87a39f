#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/surface_map.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// A short straight piece of the outline of the drivable ground.
struct OutlineStrip {
  int ring = 0,
      index = 0;      ///< of the outline, and along it; the last of a ring is followed by its first
  int ring_size = 0;  ///< strips of that ring, those that were left out too
  Eigen::Vector3d foot;      ///< [m] in site: its middle, on the ground at the outline
  Eigen::Vector2d along;     ///< unit; the drivable ground lies on the left
  double slope = 0;          ///< rise of that ground along it ...
  double slope_outward = 0;  ///< ... and across it, outward
  double height_sigma = 0;   ///< [m] of that ground, by the map

  Eigen::Vector2d Outward() const { return {along.y(), -along.x()}; }
  Eigen::Vector3d End(double distance) const {  ///< [m] in site, so far along
    return foot + distance * Eigen::Vector3d(along.x(), along.y(), slope);
  }
};

/// Cuts the outline of a mesh into strips of about `length` [m]. Where it is ragged or turns within
/// one, or where the ground beside it is not known as a plane, there is none. Heights are those of
/// the free ground just inside, which `surface` knows to more than the mesh.
std::vector<OutlineStrip> CutOutline(const TriangleMesh& mesh, const SurfaceMap& surface,
                                     double length);

}  // namespace parkade

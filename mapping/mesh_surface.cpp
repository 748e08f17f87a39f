#include "mapping/mesh_surface.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "mapping/cell_finder.h"
#include "mapping/join_cells.h"
#include "mapping/simplify_sheet.h"
#include "mapping/voxel_sheet.h"

namespace parkade {
namespace {

const SurfaceCell& FindCell(const CellFinder& finder, const Eigen::Vector3d& vertex) {
  const SurfaceCell* cell = finder.Find(vertex);
  Require(cell != nullptr, ErrorCode::kInternal, "a vertex of the mesh lies off its surface");
  return *cell;
}

/// [m] a whole-metre point amid the vertices, so that float coordinates stay small.
Eigen::Vector3d OriginOf(const std::vector<Eigen::Vector3d>& vertices) {
  if (vertices.empty()) return Eigen::Vector3d::Zero();
  Eigen::Vector3d low = vertices.front(), high = vertices.front();
  for (const Eigen::Vector3d& vertex : vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  return (0.5 * (low + high)).array().round().matrix();
}

/// Area-weighted, unit, upwards.
std::vector<Eigen::Vector3f> NormalsOf(const VoxelSheet& sheet) {
  std::vector<Eigen::Vector3d> sums(sheet.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& [a, b, c] : sheet.triangles) {
    const Eigen::Vector3d normal = (sheet.vertices[b] - sheet.vertices[a]).cross(sheet.vertices[c] - sheet.vertices[a]);
    for (const std::uint32_t vertex : {a, b, c}) sums[vertex] += normal;
  }
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(sums.size());
  for (const Eigen::Vector3d& sum : sums)
    normals.push_back(sum.norm() > 1e-12 ? Eigen::Vector3f(sum.normalized().cast<float>()) : Eigen::Vector3f::UnitZ());
  return normals;
}

}  // namespace

void MeshOptions::Validate() const {
  Require(cells_per_voxel >= 1 && cells_per_voxel <= 64, ErrorCode::kUsage, "cells_per_voxel must be in 1..64");
  Require(voxel_height > 0, ErrorCode::kUsage, "voxel_height must be > 0 m");
  Require(free_threshold > 0 && free_threshold < 1, ErrorCode::kUsage, "free_threshold must be in (0, 1)");
  Require(max_step > 0, ErrorCode::kUsage, "max_step must be > 0 m");
  Require(max_height_error > 0, ErrorCode::kUsage, "max_height_error must be > 0 m");
  Require(color_contrast >= 0, ErrorCode::kUsage, "color_contrast must not be negative");
}

TriangleMesh MeshSurface(const SurfaceMap& surface, const MeshOptions& options) {
  options.Validate();
  const SurfaceMap joined = JoinCells(surface, options.cells_per_voxel, options.free_threshold, options.max_step);
  VoxelSheet sheet = ExtractSheet(joined, options.voxel_height, options.max_step, options.free_threshold);
  const CellFinder finder(joined);
  const auto colors_of = [&](const VoxelSheet& of) {
    return ParallelMap(of.vertices.size(), [&](size_t i) { return FindCell(finder, of.vertices[i]).color; });
  };
  const size_t num_full_triangles = sheet.triangles.size();
  if (options.simplify)
    sheet = SimplifySheet(sheet, colors_of(sheet),
                          {.max_error = options.max_height_error, .color_contrast = options.color_contrast});

  TriangleMesh mesh;
  mesh.origin = OriginOf(sheet.vertices);
  mesh.triangles = sheet.triangles;
  mesh.normals = NormalsOf(sheet);
  mesh.colors = colors_of(sheet);
  mesh.vertices.reserve(sheet.vertices.size());
  mesh.height_sigmas.reserve(sheet.vertices.size());
  for (const Eigen::Vector3d& vertex : sheet.vertices) {
    mesh.vertices.push_back((vertex - mesh.origin).cast<float>());
    mesh.height_sigmas.push_back(FindCell(finder, vertex).height_sigma);
  }
  ValidateMesh(mesh);
  LogInfo("stage=mesh_surface triangles=" + std::to_string(mesh.triangles.size()) +
          " before_simplifying=" + std::to_string(num_full_triangles));
  return mesh;
}

}  // namespace parkade

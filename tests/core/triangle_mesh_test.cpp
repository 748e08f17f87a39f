#include "core/triangle_mesh.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

TriangleMesh UnitSquare() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh.colors.assign(4, {90, 90, 90});
  mesh.height_sigmas.assign(4, 0.01F);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(TriangleMesh, AreaIsOfAllTriangles) { EXPECT_NEAR(SurfaceArea(UnitSquare()), 1, 1e-7); }

TEST(TriangleMesh, BrokenPromisesAreFound) {
  EXPECT_NO_THROW(ValidateMesh(UnitSquare()));
  TriangleMesh beyond = UnitSquare(), short_arrays = UnitSquare(), not_finite = UnitSquare();
  beyond.triangles.push_back({0, 1, 4});
  short_arrays.colors.pop_back();
  not_finite.vertices[2].x() = NAN;
  EXPECT_THROW(ValidateMesh(beyond), Error);
  EXPECT_THROW(ValidateMesh(short_arrays), Error);
  EXPECT_THROW(ValidateMesh(not_finite), Error);
}

}  // namespace
}  // namespace parkade

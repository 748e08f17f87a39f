#include "mapping/evaluation/height_calibration.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// Two triangles of 4 m by 2 m at height 0.
TriangleMesh Rectangle(std::vector<float> sigmas) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}};
  mesh.height_sigmas = std::move(sigmas);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(PercentBeyondTwoSigmas, IsTheShareOfTheArea) {
  const TriangleMesh mesh = Rectangle({0.01F, 0.01F, 0.01F, 0.01F});
  const auto share_where = [&](double begin, double height) {
    return PercentBeyondTwoSigmas(mesh, [=](const Eigen::Vector3d& point) {
      return std::optional(point.x() > begin ? height : 0.0);
    });
  };
  EXPECT_EQ(share_where(0, 0.019), 0);
  EXPECT_EQ(share_where(0, -0.021), 100);
  EXPECT_NEAR(share_where(3, 0.03), 25, 3);
}

TEST(PercentBeyondTwoSigmas, FollowsTheSigmasAndLeavesOutWhatDoesNotCount) {
  const TriangleMesh mesh = Rectangle({0.01F, 0.03F, 0.03F, 0.01F});  // 0.02 in the middle
  const auto off = [](const Eigen::Vector3d&) { return std::optional(0.04); };
  EXPECT_NEAR(PercentBeyondTwoSigmas(mesh, off), 50, 5);
  const auto only_right = [](const Eigen::Vector3d& point) {
    return point.x() > 2.2 ? std::optional(0.04) : std::nullopt;
  };
  EXPECT_EQ(PercentBeyondTwoSigmas(mesh, only_right), 0);
  EXPECT_EQ(PercentBeyondTwoSigmas(Rectangle({}), off), 0) << "there are no sigmas";
}

}  // namespace
}  // namespace parkade

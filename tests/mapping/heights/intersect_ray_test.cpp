#include "mapping/heights/intersect_ray.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// Level ground that a ramp of 12 % leaves at x = 5; the ground is known to `sigma` [m].
HeightField RampAhead(double sigma) {
  std::vector<HeightObservation> heights;
  for (double x = -1; x < 14; x += 0.2)
    for (double y = -3; y < 3; y += 0.2)
      heights.push_back({{x, y, 0.12 * std::max(0.0, x - 5)}, 1 / (sigma * sigma)});
  return HeightField(heights, {});
}

TEST(IntersectRay, ARampIsMetWhereItIs) {
  const HeightField field = RampAhead(0.01);
  Eigen::Vector3d point(10, 0, 0);  // where the ray meets the level
  PatchFinder patches(field);
  ASSERT_NE(IntersectRay(patches, {0, 0, 1}, point), HeightField::kNone);

  EXPECT_NEAR(point.x(), 1.6 / 0.22, 0.1);
  EXPECT_NEAR(point.z(), 0.12 * (point.x() - 5), 0.02);
}

TEST(IsHidden, KnownGroundHidesWhatIsBehindIt) {
  const Eigen::Vector3d eye(0, 0, 1), behind(12, 0, 0);
  EXPECT_TRUE(IsHidden(RampAhead(0.01), eye, behind));
  EXPECT_FALSE(IsHidden(RampAhead(0.2), eye, behind)) << "a guess hides nothing";
}

TEST(IsHidden, NothingHidesTheGroundThatIsSeen) {
  const HeightField field = RampAhead(0.01);
  const Eigen::Vector3d eye(0, 0, 1);
  for (const double x : {2.0, 4.0, 6.0, 8.0, 10.0, 12.0}) {
    const Eigen::Vector3d point(x, 0, 0.12 * std::max(0.0, x - 5));
    EXPECT_FALSE(IsHidden(field, eye, point)) << x;
  }
}

}  // namespace
}  // namespace parkade

#include "core/ground_patch.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

TEST(GroundSample, PointsKeepTheirPlaceToHalfAMillimeter) {
  for (const Eigen::Vector3f& point :
       {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(12.3456F, -7.6543F, -0.31234F),
        Eigen::Vector3f(-31.9F, 30.1F, 6.1F)}) {
    const CompactPoint compact = point;
    EXPECT_NEAR(compact.x(), point.x(), 0.00051);
    EXPECT_NEAR(compact.y(), point.y(), 0.00051);
    EXPECT_NEAR(compact.z(), point.z(), 0.00011);
  }
}

TEST(GroundSample, PointsOutOfReachStayAtItsEnd) {
  const CompactPoint far = Eigen::Vector3f(100, -100, 50);
  EXPECT_NEAR(far.x(), 32.767, 1e-3);
  EXPECT_NEAR(far.y(), -32.767, 1e-3);
  EXPECT_NEAR(far.z(), 6.5534, 1e-3);
}

TEST(GroundSample, NumbersKeepTwoAndAHalfDigits) {
  for (const float value : {0.0F, 1.0F, 0.67F, 0.05F, 9871.3F, 3e-5F})
    EXPECT_NEAR(CompactFloat(value), value, 0.004F * value) << value;
}

}  // namespace
}  // namespace parkade

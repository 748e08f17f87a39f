#include "core/yaw.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

TEST(Yaw, IsTheHeadingOfXWhateverTheRoll) {
  for (const double yaw : {-3.0, -0.5, 0.0, 1.2, 3.1})
    for (const double roll : {0.0, 0.4}) {
      const Eigen::Quaterniond rotation(AngleAxisd(yaw, Vector3d::UnitZ()) *
                                        AngleAxisd(-0.2, Vector3d::UnitY()) *
                                        AngleAxisd(roll, Vector3d::UnitX()));
      EXPECT_NEAR(YawOf(rotation), yaw, 1e-12);
    }
}

}  // namespace
}  // namespace parkade

#include "tests/simulator/vehicle/lens_models.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rig.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

class Lens : public testing::TestWithParam<std::string> {
 protected:
  static Rig RigWith(const std::string& lens, int width, int height) {
    RigOptions options;
    options.lens = lens;
    options.width = width;
    options.height = height;
    return MakeSimulatedRig(options, 3);
  }
};

TEST_P(Lens, SeesWhatTheUsualOneSees) {
  for (const auto& [width, height] : {std::pair(640, 400), std::pair(1280, 800)}) {
    const Rig usual = RigWith("kb", width, height), rig = RigWith(GetParam(), width, height);
    for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
      for (double angle = 0.01; angle < kHalfFieldOfView; angle += 0.05) {
        for (double around = 0; around < 6; around += 0.7) {
          const Eigen::Vector3d bearing(std::sin(angle) * std::cos(around),
                                        std::sin(angle) * std::sin(around), std::cos(angle));
          const auto expected = usual.cameras[camera].model.Project(bearing),
                     pixel = rig.cameras[camera].model.Project(bearing);
          ASSERT_TRUE(expected && pixel) << angle;
          EXPECT_LT((*pixel - *expected).norm(), 1.2 * width / 640) << angle;
          const auto back = rig.cameras[camera].model.Unproject(*pixel);
          ASSERT_TRUE(back) << angle;
          EXPECT_LT((*back - bearing).norm(), 1e-6) << angle;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Lens, testing::ValuesIn(LensNames()),
                         [](const auto& info) { return info.param; });

TEST(LensModels, AnUnknownLensIsRefused) {
  RigOptions options;
  options.lens = "looking glass";
  EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade::simulator

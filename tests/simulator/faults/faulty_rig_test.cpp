#include "tests/simulator/faults/faulty_rig.h"

#include <gtest/gtest.h>

#include "tests/simulator/render/lens_cover.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

double AngleBetween(const RigCamera& a, const RigCamera& b) {
  return LogSo3(a.body_from_camera.rotation.conjugate() * b.body_from_camera.rotation).norm() *
         180 / M_PI;
}

TEST(NominalRig, IsOffByExactlyWhatWasAskedFor) {
  FaultOptions faults;
  faults.extrinsic_rotation_deg = {1, 0, 0, 2};
  faults.extrinsic_translation_cm = {3};
  faults.time_offsets = {0.02, -0.01};
  const Rig exact = TrueRig(MakeSimulatedRig({}, 1), faults);
  const Rig nominal = NominalRig(exact, faults, 1);

  const double degrees[] = {1, 0, 0, 2}, offsets[] = {0.02, -0.01, 0, 0};
  for (size_t camera = 0; camera < 4; ++camera) {
    const RigCamera &told = nominal.cameras[camera], &real = exact.cameras[camera];
    EXPECT_NEAR(AngleBetween(told, real), degrees[camera], 1e-6);
    EXPECT_NEAR((told.body_from_camera.translation - real.body_from_camera.translation).norm(),
                0.03, 1e-9);
    EXPECT_EQ(real.time_shift, offsets[camera]);
    EXPECT_EQ(told.time_shift, 0);
  }
}

TEST(NominalRig, WithoutFaultsIsTheTrueOne) {
  const Rig exact = MakeSimulatedRig({.line_delay = 3e-5}, 1), nominal = NominalRig(exact, {}, 1);
  for (size_t camera = 0; camera < 4; ++camera) {
    EXPECT_LT(AngleBetween(nominal.cameras[camera], exact.cameras[camera]), 1e-9);
    EXPECT_EQ(nominal.cameras[camera].line_delay, 3e-5);
  }
}

TEST(NominalRig, MayKnowNothingOfTheRollingShutter) {
  FaultOptions faults;
  faults.hides_line_delay = true;
  EXPECT_EQ(NominalRig(MakeSimulatedRig({.line_delay = 3e-5}, 1), faults, 1).cameras[0].line_delay,
            0);
}

TEST(KnockedCamera, TurnsByTheAngleAndHardlyMoves) {
  const RigCamera camera = MakeSimulatedRig({}, 1).cameras[1], knocked = KnockedCamera(camera, 4);

  EXPECT_NEAR(AngleBetween(camera, knocked), 4, 1e-6);
  const double moved =
      (camera.body_from_camera.translation - knocked.body_from_camera.translation).norm();
  EXPECT_GT(moved, 0.002);
  EXPECT_LT(moved, 0.03);
}

TEST(LensCover, DarknessLeavesNextToNothingAndMudLeavesWindows) {
  const cv::Size size(320, 200);
  cv::Mat behind_cap(size, CV_32FC3, cv::Scalar(1, 1, 1)), behind_mud = behind_cap.clone();
  LensCover("dark", size, 1).Apply(behind_cap);
  LensCover("mud", size, 1).Apply(behind_mud);

  EXPECT_LT(cv::mean(behind_cap)[1], 0.01);
  int num_clear = 0;
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      num_clear += behind_mud.at<cv::Vec3f>(row, column)[1] > 0.8f;
  EXPECT_GT(num_clear, 0.02 * size.area());
  EXPECT_LT(num_clear, 0.5 * size.area());
}

TEST(CoveredLens, IsCoveredInItsTimeOnly) {
  FaultOptions faults;
  faults.occlusion = {2, 5, 8, "dark"};
  faults.darkness = {20, 21};
  const cv::Size size(32, 20);
  const CoveredLens concerned(faults, 2, size, 1), other(faults, 1, size, 1);
  cv::Mat light(size, CV_32FC3, cv::Scalar(1, 1, 1));

  EXPECT_EQ(concerned.Apply(light, 4.99), "");
  EXPECT_EQ(cv::mean(light)[0], 1);
  EXPECT_EQ(other.Apply(light, 6), "");
  EXPECT_EQ(concerned.Apply(light, 6), "occlusion");
  EXPECT_LT(cv::mean(light)[0], 0.01);
  EXPECT_EQ(other.Apply(light, 20.5), "darkness");
}

}  // namespace
}  // namespace parkade::simulator

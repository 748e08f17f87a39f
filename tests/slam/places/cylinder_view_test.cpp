#include "slam/places/cylinder_view.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// Looks to the left, 20 degrees down.
RigCamera CameraOf(CameraModel model) {
  RigCamera camera;
  camera.model = std::move(model);
  Eigen::Matrix3d body_from_camera;
  body_from_camera << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  camera.body_from_camera.rotation = Eigen::Quaterniond(body_from_camera) * ExpSo3({-0.35, 0, 0});
  return camera;
}

/// An image whose brightness is a third of its column: what is warped must show the column of the
/// pixel it comes from.
void ExpectBearingsOfTheLens(const RigCamera& camera, const CylinderView& view) {
  cv::Mat1b image(camera.model.height(), camera.model.width());
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      image(row, column) = static_cast<uchar>(column / 3);
  const cv::Mat1b warped = view.Warp(image);
  int num_checked = 0;
  for (int row = 0; row < warped.rows; row += 17) {
    for (int column = 0; column < warped.cols; column += 13) {
      if (view.usable().at<uchar>(row, column) == 0) continue;
      const Eigen::Vector3d bearing = view.BearingInUpright(column, row);
      const auto pixel =
          camera.model.Project(camera.body_from_camera.rotation.conjugate() * bearing);
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(warped(row, column), pixel->x() / 3, 1.5);
      EXPECT_LT((view.ImagePoint(column, row).cast<double>() - *pixel).norm(), 1e-3);
      ++num_checked;
    }
  }
  EXPECT_GT(num_checked, 100);
}

TEST(CylinderView, BearingsAreThoseOfAFisheye) {
  const RigCamera camera =
      CameraOf({KannalaBrandtProjection{180, 180, 320, 200, 0.01, 0, 0, 0}, 640, 400});
  ExpectBearingsOfTheLens(camera, CylinderView(camera, Eigen::Quaterniond::Identity()));
}

TEST(CylinderView, ANarrowLensGetsNoEmptyGroundAndSky) {
  const RigCamera camera = CameraOf({PinholeProjection{700, 700, 320, 100}, 640, 200});
  const CylinderView view(camera, Eigen::Quaterniond::Identity());
  ExpectBearingsOfTheLens(camera, view);
  const double share = cv::countNonZero(view.usable()) / static_cast<double>(view.usable().total());
  EXPECT_GT(share, 0.4) << "of " << view.usable().size();
}

}  // namespace
}  // namespace parkade

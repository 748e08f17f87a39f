#include "mapping/networks/level_view.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace parkade {
namespace {

constexpr int kWidth = 640, kHeight = 400;

const KannalaBrandtProjection kFisheye{
    .fx = 198, .fy = 199, .cx = 321, .cy = 202, .k1 = 0.01, .k2 = -0.002};

/// A camera `height` above the ground that looks along azimuth `heading` [rad] and down by `nod`,
/// rolled by `roll`.
Rigid3 Mounted(double heading, double nod, double roll, double height) {
  const Eigen::Matrix3d ahead = (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ())) *
      Eigen::AngleAxisd(nod, Eigen::Vector3d::UnitY()) * Eigen::Quaterniond(ahead) *
      Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  return {turned.normalized(), {1, 2, height}};
}

/// White dots on black where the camera sees the points.
cv::Mat ImageOf(const CameraModel& model, const Rigid3& ground_from_camera,
                const Eigen::Vector3d& point) {
  const Eigen::Vector2d pixel = model.Project(ground_from_camera.Inverse() * point).value();
  cv::Mat image(model.height(), model.width(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<uchar>(y, x) =
          static_cast<uchar>(255 * std::exp(-0.25 * (pixel - Eigen::Vector2d(x, y)).squaredNorm()));
  return image;
}

/// [px] the middle of what is bright.
Eigen::Vector2d MiddleOf(const cv::Mat& image) {
  const cv::Moments moments = cv::moments(image);
  return {moments.m10 / moments.m00, moments.m01 / moments.m00};
}

TEST(LevelView, WhatItShowsIsWhereItSays) {
  const DoubleSphereProjection sphere{
      .xi = 0.1, .alpha = 0.6, .fx = 210, .fy = 210, .cx = 319, .cy = 199};
  const Rigid3 ground_from_camera = Mounted(1.2, 0.4, 0.1, 0.9);
  for (const CameraModel& model :
       {CameraModel(kFisheye, kWidth, kHeight), CameraModel(sphere, kWidth, kHeight)}) {
    const LevelView view = LevelView::Of(model, ground_from_camera).value();
    for (const double range : {2.0, 5.0, 9.0})
      for (const double azimuth : {-0.9, 0.0, 1.0}) {
        const Eigen::Vector3d offset(range * std::cos(1.2 + azimuth),
                                     range * std::sin(1.2 + azimuth), -0.9);
        const cv::Mat shown =
            view.Show(ImageOf(model, ground_from_camera, ground_from_camera.translation + offset));

        EXPECT_EQ(shown.size(), cv::Size(LevelView::kWidth, LevelView::kHeight));
        EXPECT_NEAR((MiddleOf(shown) - view.PixelOf(offset).cast<double>()).norm(), 0, 0.25)
            << range << " " << azimuth;
      }
  }
}

TEST(LevelView, FineImagesAreAveraged) {
  const KannalaBrandtProjection fine{.fx = 990, .fy = 990, .cx = 1599.5, .cy = 999.5};
  const LevelView view = LevelView::Of({fine, 3200, 2000}, Mounted(0, 0.2, 0, 1)).value();
  cv::Mat stripes(2000, 3200, CV_8UC1, cv::Scalar(0));
  for (int x = 0; x < stripes.cols; x += 2) stripes.col(x).setTo(200);

  const cv::Mat shown = view.Show(stripes);

  for (int column = 300; column < 500; ++column)
    EXPECT_NEAR(shown.at<uchar>(100, column), 100, 30) << column;
}

TEST(LevelView, ItsAnglesAreThoseThatTheNetworkWasTrainedWith) {
  const LevelView view = LevelView::Of({kFisheye, kWidth, kHeight}, Mounted(0, 0.2, 0, 1)).value();

  // As pixel_of of training/level_view.py has them.
  EXPECT_NEAR((view.PixelOf({8, 0, -1}) - Eigen::Vector2f(415.5F, 100.411F)).norm(), 0, 0.01);
  EXPECT_NEAR((view.PixelOf({3, 3, -1}) - Eigen::Vector2f(219.848F, 140.948F)).norm(), 0, 0.01);
  EXPECT_NEAR((view.PixelOf({0.5, -2, -1}) - Eigen::Vector2f(745.777F, 200.542F)).norm(), 0, 0.01);
  EXPECT_NEAR((view.PixelOf({4, 1, 0.3}) - Eigen::Vector2f(354.473F, 27.532F)).norm(), 0, 0.01);
}

TEST(LevelView, GroundAsFarAsTheCameraIsHighTimesEightGetsTwiceTheRowsOfTheFisheye) {
  const CameraModel model(kFisheye, kWidth, kHeight);
  const Rigid3 ground_from_camera = Mounted(0, 0.2, 0, 1);
  const LevelView view = LevelView::Of(model, ground_from_camera).value();
  const Eigen::Vector3d near(7.5, 0, -1), far(8.5, 0, -1);
  const auto row_in_image = [&](const Eigen::Vector3d& offset) {
    return model.Project(ground_from_camera.rotation.conjugate() * offset).value().y();
  };

  const double in_image = row_in_image(near) - row_in_image(far);
  EXPECT_GT(static_cast<double>(view.PixelOf(near).y() - view.PixelOf(far).y()), 1.9 * in_image);
}

TEST(LevelView, BesideTheImageItIsBlack) {
  const cv::Mat white(kHeight, kWidth, CV_8UC3, cv::Scalar::all(255));
  const cv::Mat shown =
      LevelView::Of({kFisheye, kWidth, kHeight}, Mounted(0, 0.2, 0, 1)).value().Show(white);

  EXPECT_EQ(shown.at<cv::Vec3b>(120, LevelView::kWidth / 2), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(shown.at<cv::Vec3b>(LevelView::kHeight - 1, 2), cv::Vec3b(0, 0, 0));
}

TEST(LevelView, ANarrowLensHasNone) {
  const PinholeProjection narrow{.fx = 500, .fy = 500, .cx = 320, .cy = 200};
  EXPECT_FALSE(LevelView::Of({narrow, kWidth, kHeight}, Mounted(0, 0.1, 0, 1.5)));
  EXPECT_FALSE(LevelView::Of({kFisheye, kWidth, kHeight}, Mounted(0, -1.5, 0, 1)))
      << "it looks at the sky";
}

}  // namespace
}  // namespace parkade

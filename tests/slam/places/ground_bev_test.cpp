#include "slam/places/ground_bev.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "tests/slam/worlds/rendered_room.h"

namespace parkade {
namespace {

const RenderedRoom kRoom({-30, -30, 0}, {30, 30, 5}, 3);
const Rigid3 kRoomFromPlace{ExpSo3({0, 0, 0.7}), {2, -3, 0}};

/// On the right side of a car, half a radian down.
RigCamera RightCamera() {
  RigCamera camera;
  camera.model = SurroundFisheye();
  Eigen::Matrix3d body_from_camera;
  body_from_camera.col(0) = Eigen::Vector3d(-1, 0, 0);
  body_from_camera.col(2) = Eigen::Vector3d(0, -std::cos(0.5), -std::sin(0.5));
  body_from_camera.col(1) = body_from_camera.col(2).cross(body_from_camera.col(0));
  camera.body_from_camera = {Eigen::Quaterniond(body_from_camera), {2, -1, 1}};
  return camera;
}

cv::Mat ImageOf(const RigCamera& camera, const Rigid3& keyframe_from_body) {
  return RoomCamera(camera.model, kRoom)
      .Render(kRoomFromPlace * keyframe_from_body * camera.body_from_camera);
}

Eigen::Vector3d MiddleOf(int row, int column) {
  return {kFloorFront - (row + 0.5) * kFloorCell, kFloorLeft - (column + 0.5) * kFloorCell, 0};
}

/// Correlation of the image with the true floor, shifted by some cells.
double CorrelationWithTruth(const cv::Mat& image, int rows = 0, int columns = 0) {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      if (image.at<uchar>(row, column) == 0) continue;
      const double seen = image.at<uchar>(row, column);
      const double truth =
          kRoom.BrightnessAt(kRoomFromPlace * MiddleOf(row + rows, column + columns), 0.06);
      n += 1, x += seen, y += truth, xx += seen * seen, yy += truth * truth, xy += seen * truth;
    }
  }
  return (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
}

TEST(GroundBevView, ShowsTheGroundWhereItLiesWhereverTheCarIsByThen) {
  const RigCamera camera = RightCamera();
  const GroundBevView view(camera);
  for (const Rigid3& keyframe_from_body : {Rigid3(), Rigid3{ExpSo3({0, 0, 0.2}), {0.6, -0.3, 0}}}) {
    const GroundBev observation =
        view.Look(ImageOf(camera, keyframe_from_body), keyframe_from_body, 0);
    EXPECT_GT(cv::countNonZero(observation.image), 5000)
        << "of 40,000 cells, on the right of the car";
    EXPECT_EQ(cv::countNonZero(observation.image(cv::Rect(0, 0, 60, 200))), 0)
        << "and none on its left";
    const double found = CorrelationWithTruth(observation.image);
    EXPECT_GT(found, 0.6) << "the floor's slow changes are taken for light";
    for (const int off : {-1, 1}) {
      EXPECT_LT(CorrelationWithTruth(observation.image, off, 0), found) << "5 cm ahead or behind";
      EXPECT_LT(CorrelationWithTruth(observation.image, 0, off), found) << "5 cm beside it";
    }
  }
}

TEST(GroundBevView, WhatTheMaskHidesIsUnseen) {
  RigCamera camera = RightCamera();
  camera.mask = cv::Mat(camera.model.height(), camera.model.width(), CV_8UC1, cv::Scalar(255));
  camera.mask(cv::Rect(0, 0, camera.model.width() / 2, camera.model.height())) = 0;
  const GroundBev all = GroundBevView(RightCamera()).Look(ImageOf(camera, {}), {}, 0);
  const GroundBev half = GroundBevView(camera).Look(ImageOf(camera, {}), {}, 0);
  EXPECT_GT(cv::countNonZero(half.image), 0.4 * cv::countNonZero(all.image));
  EXPECT_LT(cv::countNonZero(half.image), 0.6 * cv::countNonZero(all.image));
}

TEST(GroundBevView, TheSharperObservationOfACellStays) {
  GroundBev floor;
  AddObservation(
      {cv::Mat(kFloorSize, CV_8UC1, cv::Scalar(10)), cv::Mat(kFloorSize, CV_32FC1, cv::Scalar(50)),
       cv::Mat(kFloorSize, CV_8UC1, cv::Scalar(0))},
      floor);
  GroundBev second{cv::Mat(kFloorSize, CV_8UC1, cv::Scalar(20)),
                   cv::Mat(kFloorSize, CV_32FC1, cv::Scalar(40)),
                   cv::Mat(kFloorSize, CV_8UC1, cv::Scalar(1))};
  second.sharpness.rowRange(7, 60) = 60;
  AddObservation(second, floor);
  EXPECT_EQ(floor.image.at<uchar>(6, 100), 10);
  EXPECT_EQ(floor.image.at<uchar>(7, 100), 20);
  EXPECT_EQ(floor.sharpness.at<float>(7, 100), 60);
  const cv::Mat image = ImageOf(floor);
  EXPECT_EQ(image.at<uchar>(5, 100), 10);
  EXPECT_EQ(image.at<uchar>(7, 100), 0) << "a seam";
  EXPECT_EQ(image.at<uchar>(8, 100), 20);
}

}  // namespace
}  // namespace parkade

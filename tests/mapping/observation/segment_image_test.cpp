#include "mapping/observation/segment_image.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "core/error.h"
#include "mapping/networks/level_view.h"

namespace parkade {
namespace {

/// A fisheye of 160 x 100 pixels, a meter above the ground, that looks ahead and a little down.
struct Fisheye {
  CameraModel model{KannalaBrandtProjection{.fx = 49.5, .fy = 49.5, .cx = 79.5, .cy = 49.5}, 160,
                    100};
  Rigid3 ground_from_camera{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())) *
          Eigen::Quaterniond((Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished()),
      {0, 0, 1}};
  cv::Mat image = cv::Mat(100, 160, CV_8UC3);

  Fisheye() { cv::randu(image, 0, 255); }
};

TEST(SegmentImage, AsksTheViewWhereItReachesAndTheImageElsewhere) {
  const Fisheye camera;
  const ImageNetworks networks;
  const LevelView view = LevelView::Of(camera.model, camera.ground_from_camera).value();
  const FreespaceBelief of_view = networks.of_views->Run(view.Show(camera.image));
  const FreespaceBelief of_image = networks.of_images.Run(camera.image);

  const FreespaceBelief belief =
      SegmentImage(networks, camera.model, camera.ground_from_camera, camera.image);

  const cv::Point far(80, 45), at_the_foot(80, 97);
  const Eigen::Vector3d bearing = camera.model.Unproject({far.x, far.y}).value();
  const Eigen::Vector2f pixel = view.PixelOf(camera.ground_from_camera.rotation * bearing);
  EXPECT_TRUE(of_view.Covers(pixel));
  EXPECT_FLOAT_EQ(belief.log_odds.at<float>(far), of_view.At(pixel));
  EXPECT_FLOAT_EQ(belief.log_odds.at<float>(at_the_foot), of_image.At({80, 97}));
}

TEST(SegmentImage, PicturesOfAnotherSizeAreRefused) {
  const Fisheye camera;
  try {
    SegmentImage(ImageNetworks{}, camera.model, camera.ground_from_camera,
                 cv::Mat(50, 80, CV_8UC3, cv::Scalar::all(0)));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    EXPECT_NE(std::string(error.what()).find("160x100"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace parkade

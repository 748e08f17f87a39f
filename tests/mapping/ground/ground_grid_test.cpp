#include "mapping/ground/ground_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

std::ptrdiff_t NumVisible(const GroundGrid& grid) {
  return std::count_if(grid.cells.begin(), grid.cells.end(),
                       [](const GroundGridCell& cell) { return cell.is_visible; });
}

class GroundGridOfARig : public testing::Test {
 protected:
  void SetUp() override { ASSERT_GT(NumVisible(grid_), 100); }

  const Rig rig_ = MakeTestRig();
  const WheelbaseFootprint contact_ = WheelbaseFootprint::Of(rig_);
  const RigCamera& camera_ = rig_.cameras[0];
  const GroundGrid grid_ = MakeGroundGrid(camera_, camera_.body_from_camera, contact_);
};

TEST_F(GroundGridOfARig, EachVisiblePlaceIsWhereItsPixelMeetsThePlane) {
  // The slow way: the ray of the pixel, cut with z = 0.
  int count = 0;
  for (const GroundGridCell& cell : grid_.cells) {
    if (!cell.is_visible || ++count % 7 != 0) continue;
    const Eigen::Vector3d ray = camera_.body_from_camera.rotation *
                                camera_.model.Unproject(cell.pixel.cast<double>()).value();
    const Eigen::Vector3d& eye = camera_.body_from_camera.translation;
    const Eigen::Vector3d point = eye - eye.z() / ray.z() * ray;
    const double range = (point - eye).norm();
    EXPECT_NEAR((point.head<2>() - cell.point_in_ground.cast<double>()).norm(), 0,
                1e-4 * range * range + 1e-4);
  }
  EXPECT_GT(count, 3000);
}

TEST_F(GroundGridOfARig, NoPlaceIsSeenInLongerPixelsThanAskedOrUnderTheCar) {
  const GroundGridOptions options;
  const double height = camera_.body_from_camera.translation.z();
  const Eigen::Vector2d middle(0.5 * camera_.model.width(), 0.5 * camera_.model.height());
  const double farthest =
      std::sqrt(options.max_pixel_length * height * camera_.model.PixelsPerRadian(middle).value() -
                height * height);
  for (const GroundGridCell& cell : grid_.cells) {
    const Eigen::Vector2d point = cell.point_in_ground.cast<double>();
    if (!cell.is_visible) continue;
    EXPECT_LT((point - camera_.body_from_camera.translation.head<2>()).norm(),
              std::min(farthest, options.max_range + 1));
    EXPECT_GT(contact_.DistanceTo(point), 0.39);
  }
}

TEST_F(GroundGridOfARig, WeightsFallWithTheDistanceFromTheWheels) {
  const GroundGridOptions options;
  for (const GroundGridCell& cell : grid_.cells) {
    if (!cell.is_visible) continue;
    const double d = contact_.DistanceTo(cell.point_in_ground.cast<double>());
    const double variance = std::pow(d * options.pitch_sigma, 2) +
                            std::pow(0.5 * options.curvature_sigma * d * d, 2) +
                            std::pow(options.height_sigma, 2);
    EXPECT_NEAR(static_cast<double>(cell.weight) * variance, 1, 1e-3);
  }
}

TEST_F(GroundGridOfARig, MaskedPixelsAreNotVisible) {
  RigCamera masked = camera_;
  masked.mask = cv::Mat(masked.model.height(), masked.model.width(), CV_8UC1, cv::Scalar(255));
  masked.mask(cv::Rect(0, 0, masked.model.width() / 2, masked.model.height())).setTo(0);

  const GroundGrid grid = MakeGroundGrid(masked, masked.body_from_camera, contact_);

  ASSERT_GT(NumVisible(grid), 50);
  for (const GroundGridCell& cell : grid.cells) {
    if (!cell.is_visible) continue;
    EXPECT_GE(cell.pixel.x(), static_cast<float>(masked.model.width()) / 2 - 1);
  }
}

TEST_F(GroundGridOfARig, ColorsOfALinearImageAreExact) {
  cv::Mat image(camera_.model.height(), camera_.model.width(), CV_8UC3);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<cv::Vec3b>(y, x) = {static_cast<uchar>(x / 2), static_cast<uchar>(y), 77};

  const cv::Mat colors = SampleColors(grid_, image);

  for (size_t i = 0; i < grid_.cells.size(); ++i) {
    if (!grid_.cells[i].is_visible) continue;
    const uchar* color = colors.ptr() + 3 * i;
    EXPECT_NEAR(color[0], grid_.cells[i].pixel.x() / 2, 1.1);
    const bool is_cut_off =
        grid_.cells[i].pixel.y() > static_cast<float>(image.rows - 3);  // its share is
    EXPECT_NEAR(color[1], grid_.cells[i].pixel.y(), is_cut_off ? 0.7 : 0.51);
    EXPECT_EQ(color[2], 77);
  }
}

TEST_F(GroundGridOfARig, AFineTextureGivesItsMeanWhereCellsHoldManyPixels) {
  cv::Mat image(camera_.model.height(), camera_.model.width(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) image.at<uchar>(y, x) = (x + y) % 2 == 0 ? 40 : 200;

  const cv::Mat colors = SampleColors(grid_, image);

  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < grid_.cells.size(); ++i)
    if (grid_.cells[i].is_visible) sum += std::pow(colors.ptr()[3 * i] - 120, 2), ++count;
  EXPECT_LT(std::sqrt(sum / count), 20) << "of 80 that single pixels would give";
}

TEST_F(GroundGridOfARig, GrayImagesGiveGrayColors) {
  const cv::Mat image(camera_.model.height(), camera_.model.width(), CV_8UC1, cv::Scalar(42));

  const cv::Mat colors = SampleColors(grid_, image);

  for (size_t i = 0; i < grid_.cells.size(); ++i) {
    if (!grid_.cells[i].is_visible) continue;
    EXPECT_EQ(colors.ptr()[3 * i], 42);
    EXPECT_EQ(colors.ptr()[3 * i + 2], 42);
  }
}

TEST(GroundGrid, ANarrowLensThatLooksAheadIsGivenItsFirstMetersToo) {
  RigCamera camera;
  camera.model =
      CameraModel(PinholeProjection{.fx = 700, .fy = 700, .cx = 600, .cy = 180}, 1200, 360);
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // looks along x, level
  camera.body_from_camera = {Eigen::Quaterniond(axes), {0, 0, 1.65}};

  const GroundGrid grid = MakeGroundGrid(camera, camera.body_from_camera, WheelbaseFootprint{});

  float nearest = 100, farthest = 0;
  for (const GroundGridCell& cell : grid.cells) {
    if (!cell.is_visible) continue;
    nearest = std::min(nearest, cell.point_in_ground.norm());
    farthest = std::max(farthest, cell.point_in_ground.norm());
  }
  EXPECT_NEAR(nearest, 1.65 * 700 / 179, 0.4);
  EXPECT_GT(farthest, 12);
}

TEST(GroundGrid, ACameraBelowTheGroundSeesNone) {
  const Rig rig = MakeTestRig();
  Rigid3 buried = rig.cameras[0].body_from_camera;
  buried.translation.z() = -0.5;

  EXPECT_TRUE(MakeGroundGrid(rig.cameras[0], buried, WheelbaseFootprint::Of(rig)).cells.empty());
}

TEST(GroundGrid, RejectsASpacingOfZero) {
  GroundGridOptions options;
  options.spacing = 0;
  EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade

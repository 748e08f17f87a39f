#include "mapping/texture/chart_painter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/mapping/worlds/all_charts.h"
#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

constexpr double kTexel = 0.02;

/// A smooth pattern on the ground with waves of about a meter.
Eigen::Vector3d PatternAt(double x, double y) {
  return {120 + 60 * std::sin(5 * x + 1), 120 + 60 * std::sin(6 * y),
          120 + 50 * std::sin(4 * x - 3 * y)};
}

/// A fisheye 1.2 m above `place`, looking ahead (+x) and half down.
RigCamera MakeCamera() {
  RigCamera camera;
  camera.name = "cam0";
  camera.model = CameraModel(
      KannalaBrandtProjection{.fx = 300, .fy = 300, .cx = 319.5, .cy = 239.5}, 640, 480);
  return camera;
}

Rigid3 LookFrom(const Eigen::Vector3d& place) {
  const double down = 50 * M_PI / 180;
  Eigen::Matrix3d site_from_camera;
  const Eigen::Vector3d z(std::cos(down), 0, -std::sin(down)), x(0, -1, 0);
  site_from_camera << x, z.cross(x), z;
  return {Eigen::Quaterniond(site_from_camera), place};
}

/// What the camera sees of the patterned plane z = 0.1 x, by casting a ray per pixel.
cv::Mat Photograph(const RigCamera& camera, const Rigid3& site_from_camera) {
  cv::Mat image(camera.model.height(), camera.model.width(), CV_8UC3, cv::Scalar::all(0));
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.1, 0, 1).normalized();
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column) {
      const auto ray = camera.model.Unproject({column, row});
      if (!ray) continue;
      const Eigen::Vector3d direction = site_from_camera.rotation * *ray;
      const double distance = -normal.dot(site_from_camera.translation) / normal.dot(direction);
      if (!(distance > 0)) continue;
      const Eigen::Vector3d point = site_from_camera.translation + distance * direction;
      const Eigen::Vector3d color = PatternAt(point.x(), point.y());
      image.at<cv::Vec3b>(row, column) = {static_cast<uchar>(std::lround(color[0])),
                                          static_cast<uchar>(std::lround(color[1])),
                                          static_cast<uchar>(std::lround(color[2]))};
    }
  return image;
}

TriangleMesh MakeSlope() {
  TriangleMesh mesh;
  AddRectangle(mesh, 0, 0, 6, 4, 0);
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex.z() = 0.1F * vertex.x();
  return mesh;
}

GroundImage ImageFrom(const RigCamera& camera, const Eigen::Vector3d& place) {
  const Rigid3 pose = LookFrom(place);
  GroundImage image;
  image.image = Photograph(camera, pose);
  image.camera = &camera;
  image.site_from_camera = pose;
  return image;
}

/// Largest and mean difference of the painted chart from the pattern.
struct Difference {
  double largest = 0, mean = 0;
  int compared = 0;
};
Difference CompareWithPattern(const TextureChart& chart, double x0, double x1, double y0,
                              double y1) {
  Difference difference;
  for (int row = 0; row < chart.image.rows; ++row)
    for (int column = 0; column < chart.image.cols; ++column) {
      const double x = chart.left + kTexel * (column + 0.5), y = chart.top - kTexel * (row + 0.5);
      if (x < x0 || x > x1 || y < y0 || y > y1) continue;
      const Eigen::Vector3d color = PatternAt(x, y);
      for (int c = 0; c < 3; ++c) {
        const double off = std::abs(color[c] - chart.image.at<cv::Vec3b>(row, column)[c]);
        difference.largest = std::max(difference.largest, off);
        difference.mean += off;
        ++difference.compared;
      }
    }
  difference.mean /= std::max(1, difference.compared);
  return difference;
}

class ChartPainters : public testing::Test {
 protected:
  ChartPainters()
      : surface_(MakeSurface(120, 80, 0.05, [](double x, double) { return 0.1 * x; })),
        cells_(surface_) {}

  ChartPainter NewPainter() const {
    return ChartPainter(CutIntoCharts(MakeSlope(), 100, kTexel).at(0), kTexel);
  }

  RigCamera camera_ = MakeCamera();
  SurfaceMap surface_;
  CellFinder cells_;
};

TEST_F(ChartPainters, PutThePatternOfTheGroundWhereItIs) {
  ChartPainter painter = NewPainter();
  for (const double x : {0.0, 1.0, 2.0, 3.0})
    painter.Paint(ImageFrom(camera_, {x, 2, 1.2 + 0.1 * x}), 4);

  const Difference difference = CompareWithPattern(painter.Finish(cells_), 1, 5, 1, 3);

  ASSERT_GT(difference.compared, 50000);
  EXPECT_LT(difference.mean, 1.5);
  EXPECT_LT(difference.largest, 12);
}

/// Images that are surely not among the best are left out, and the picture is the same but for
/// texels of which a camera at its edge shows every second one.
TEST_F(ChartPainters, LookOnlyAtTheBestOfTheImagesThatTheyExpect) {
  ChartPainter expecting = NewPainter(), looking_at_all = NewPainter();
  std::vector<GroundImage> images;
  for (int i = 0; i < 12; ++i) {
    const double x = 0.3 * i - 1;
    images.push_back(ImageFrom(camera_, {x, 2 + 0.1 * (i % 3), 1.2 + 0.1 * x}));
    images.back().image *= 0.7 + 0.05 * i;  // which ones were taken shows
  }
  std::vector<const GroundImage*> expected;
  expected.reserve(images.size());
  for (const GroundImage& image : images) expected.push_back(&image);
  expecting.Expect(expected, 4);
  for (const GroundImage& image : images) {
    expecting.Paint(image, 4);
    looking_at_all.Paint(image, 4);
  }

  const TextureChart chart = expecting.Finish(cells_), other = looking_at_all.Finish(cells_);

  cv::Mat difference;
  cv::absdiff(chart.image, other.image, difference);
  EXPECT_LE(cv::norm(difference, cv::NORM_INF), 4);
  EXPECT_LT(cv::mean(difference)[0], 0.002);
  EXPECT_EQ(cv::norm(chart.mask, other.mask, cv::NORM_INF), 0);
}

/// An image after steeper ones is left out where it adds nothing; first, it is painted and pushed
/// out.
TEST_F(ChartPainters, LeaveOutOnlyWhatAddsNothing) {
  ChartPainter near_first = NewPainter(), far_first = NewPainter();
  const std::vector<double> places{2, 1.6, 1.2, 0.8, 0.4, 0};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double near = places[i], far = places[places.size() - 1 - i];
    near_first.Paint(ImageFrom(camera_, {near, 2, 1.2 + 0.1 * near}), 4);
    far_first.Paint(ImageFrom(camera_, {far, 2, 1.2 + 0.1 * far}), 4);
  }

  const TextureChart chart = near_first.Finish(cells_), other = far_first.Finish(cells_);

  cv::Mat difference;
  cv::absdiff(chart.image, other.image, difference);
  EXPECT_LT(cv::mean(difference)[0], 0.05) << "but for observations that rank alike";
  EXPECT_EQ(cv::norm(chart.mask, other.mask, cv::NORM_INF), 0);
}

TEST_F(ChartPainters, ForgetWhatOnlyOnePhotoShows) {
  ChartPainter painter = NewPainter();
  for (const double x : {0.0, 1.0, 1.5, 2.0}) {
    GroundImage image = ImageFrom(camera_, {x, 2, 1.2 + 0.1 * x});
    if (x == 1.5)
      cv::rectangle(image.image, cv::Rect(200, 150, 240, 200), cv::Scalar::all(255), cv::FILLED);
    painter.Paint(image, 4);
  }

  EXPECT_LT(CompareWithPattern(painter.Finish(cells_), 2.2, 4, 1.5, 2.5).mean, 3);
}

TEST_F(ChartPainters, ShowTheLatestDriveWhereItSawThePlace) {
  ChartPainter painter = NewPainter();
  for (const double x : {-1.0, 0.0, 1.0, 1.5, 2.0, 2.5}) {
    GroundImage image = ImageFrom(camera_, {x, 2, 1.2 + 0.1 * x});
    image.image.setTo(cv::Scalar::all(200));
    image.drive = 3;
    painter.Paint(image, 4);
  }
  GroundImage later = ImageFrom(camera_, {1, 2, 1.3});
  later.image.setTo(cv::Scalar::all(120));
  later.drive = 7;
  painter.Paint(later, 2);

  const TextureChart chart = painter.Finish(cells_);

  const auto blue_at = [&](double x) {
    return chart.image.at<cv::Vec3b>(chart.image.rows / 2,
                                     static_cast<int>((x - chart.left) / kTexel))[0];
  };
  EXPECT_EQ(blue_at(2), 120) << "although the earlier drive saw it four times, and more steeply";
  EXPECT_EQ(blue_at(2.8), 120);
  EXPECT_EQ(blue_at(4), 200) << "beyond what the later one saw";
}

TEST_F(ChartPainters, ADriveThatDoesNotShowATexelTakesNothingFromIt) {
  ChartPainter painter = NewPainter();
  const auto paint = [&](int drive, double x, double max_range, double gray) {
    GroundImage image = ImageFrom(camera_, {x, 2, 1.2 + 0.1 * x});
    image.image.setTo(cv::Scalar::all(gray));
    image.drive = drive;
    painter.Paint(image, max_range);
  };
  paint(0, 2, 4, 90);     // shows x = 2.5 steeply,
  paint(1, 4.5, 4, 150);  // nothing of it,
  paint(2, -6, 9, 200);   // and flatly: a little less than an eighth

  const TextureChart chart = painter.Finish(cells_);

  EXPECT_EQ(chart.image.at<cv::Vec3b>(chart.image.rows / 2,
                                      static_cast<int>((2.5 - chart.left) / kTexel))[0],
            90);
}

TEST_F(ChartPainters, LeaveMaskedPixelsAndFarGroundToTheColorsOfTheCells) {
  camera_.mask = cv::Mat(480, 640, CV_8UC1, cv::Scalar(0));
  ChartPainter painter = NewPainter();
  painter.Paint(ImageFrom(camera_, {1, 2, 1.3}), 4);
  camera_.mask.release();
  painter.Paint(ImageFrom(camera_, {-3, 2, 0.9}), 4);  // reaches x = 1

  const TextureChart chart = painter.Finish(cells_);

  const int row = chart.image.rows / 2;
  EXPECT_EQ(chart.image.at<cv::Vec3b>(row, chart.image.cols - 10), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(chart.image.at<cv::Vec3b>(row, static_cast<int>(2 / kTexel)), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(chart.mask.at<std::uint8_t>(row, static_cast<int>(2 / kTexel)), TextureChart::kPlain);
  EXPECT_EQ(chart.mask.at<std::uint8_t>(row, static_cast<int>(0.7 / kTexel)),
            TextureChart::kPainted);
}

TEST_F(ChartPainters, DoNotPaintThePlaceTheOwnCarStandsOn) {
  ChartPainter painter = NewPainter();
  GroundImage image = ImageFrom(camera_, {1, 2, 1.3});
  image.site_from_ground.translation = {1.5, 2, 0.15};
  image.contact = {.wheelbase = 1.0, .track = 1.0};
  painter.Paint(image, 4);

  const TextureChart chart = painter.Finish(cells_);

  const auto kind_at = [&](double x, double y) {
    return chart.mask.at<std::uint8_t>(static_cast<int>((chart.top - y) / kTexel),
                                       static_cast<int>((x - chart.left) / kTexel));
  };
  EXPECT_EQ(kind_at(2.0, 2.0), TextureChart::kPlain);
  EXPECT_EQ(kind_at(3.5, 2.0), TextureChart::kPainted);
}

/// Its floor hides the one below, which from up there would be seen more steeply than from anywhere
/// on it.
TEST_F(ChartPainters, DoNotPaintTheDeckBelow) {
  ChartPainter painter = NewPainter();
  GroundImage image = ImageFrom(camera_, {1, 2, 3.9});
  image.site_from_ground.translation = {1, 2, 2.7};
  painter.Paint(image, 4);

  EXPECT_EQ(cv::countNonZero(painter.Finish(cells_).mask == TextureChart::kPainted), 0);
}

TEST_F(ChartPainters, ContinueTheBordersColorBeyondTheMesh) {
  const TextureChart chart = NewPainter().Finish(cells_);

  EXPECT_EQ(chart.mask.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(chart.image.at<cv::Vec3b>(0, 0), cv::Vec3b(100, 100, 100));
}

TEST_F(ChartPainters, FindTheGainOfADarkPhoto) {
  GroundImage image = ImageFrom(camera_, {2, 2, 1.4});
  image.image = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(60));
  EXPECT_TRUE(FindGain(image, cells_, 4).isApproxToConstant(100.0F / 60, 0.01F));
  image.image.setTo(cv::Scalar(80, 50, 125));
  EXPECT_TRUE(FindGain(image, cells_, 4).isApprox(Eigen::Array3f(1.25F, 2, 0.8F), 0.01F))
      << "blue light";
  image.image.setTo(cv::Scalar::all(10));
  EXPECT_TRUE((FindGain(image, cells_, 4) == 3).all());
  image.site_from_camera.translation.x() = 50;
  EXPECT_TRUE((FindGain(image, cells_, 4) == 1).all()) << "nothing of the surface is seen";
}

}  // namespace
}  // namespace parkade

#include "core/camera_projections.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/ccalib/omnidir.hpp>
#include <random>

#include "core/camera_model.h"
#include "core/error.h"

namespace parkade {
namespace {

struct NamedLens {
  const char* name;
  CameraModel model;
  double min_field_deg;  ///< full field of view inside the image circle that the model must cover
};

void PrintTo(const NamedLens& lens, std::ostream* out) { *out << lens.name; }

// One lens of each kind as they are sold for cars and robots, and the corner cases of each domain.
std::vector<NamedLens> Lenses() {
  constexpr double kFx = 320, kFy = 322, kCx = 641.3, kCy = 478.9;
  const auto make = [](const char* name, CameraModel::Projection projection, double field) {
    return NamedLens{name, CameraModel(std::move(projection), 1280, 960), field};
  };
  return {
      make("Pinhole", PinholeProjection{700, 702, kCx, kCy}, 70),
      make("RadTanOfEuroc", RadTanProjection{458, 457, kCx, kCy, {-0.28, 0.074, 2e-4, 2e-5}}, 90),
      make("RadTanThatFolds", RadTanProjection{700, 700, kCx, kCy, {-0.4, 0.1, -1e-3, 2e-3, 0.01}},
           70),
      make("KannalaBrandt",
           KannalaBrandtProjection{kFx, kFy, kCx, kCy, -0.013, 0.021, -0.012, 0.0021}, 200),
      make("KannalaBrandtThatFolds",
           KannalaBrandtProjection{kFx, kFy, kCx, kCy, -0.05, -0.004, 0, 0}, 190),
      make("PureEquidistant", KannalaBrandtProjection{kFx, kFy, kCx, kCy}, 200),
      make("Mei", MeiProjection{1.7, 850, 851, kCx, kCy, {-0.1, 0.2, 3e-4, -2e-4}}, 190),
      make("MeiOfSmallXi", MeiProjection{0.8, 500, 501, kCx, kCy, {}}, 180),
      make("Eucm", EucmProjection{0.63, 1.04, kFx, kFy, kCx, kCy}, 190),
      make("EucmOfSmallAlpha", EucmProjection{0.35, 0.9, kFx, kFy, kCx, kCy}, 150),
      make("DoubleSphere", DoubleSphereProjection{-0.18, 0.59, kFx, kFy, kCx, kCy}, 190),
      make("DoubleSphereOfPositiveXi", DoubleSphereProjection{0.3, 0.62, 400, 401, kCx, kCy}, 200),
      make("Ocam", OcamProjection{329, -1.6e-3, 1.1e-6, -1.9e-9, kCx, kCy, 0.9998, 4.9e-4, 2.4e-4},
           190),
  };
}

class EveryLens : public testing::TestWithParam<NamedLens> {
 protected:
  const CameraModel& lens() const { return GetParam().model; }

  // Uniform over the sphere.
  static std::vector<Eigen::Vector3d> Bearings(int count) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Vector3d> bearings;
    for (int i = 0; i < count; ++i)
      bearings.push_back(
          Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
    return bearings;
  }
};

INSTANTIATE_TEST_SUITE_P(Lenses, EveryLens, testing::ValuesIn(Lenses()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(EveryLens, ProjectingAnUnprojectedPixelGivesThePixelOverTheWholeImage) {
  int num_pixels = 0;
  double max_error = 0;
  for (double v = -0.5; v < lens().height(); v += 3.7) {
    for (double u = -0.5; u < lens().width(); u += 3.7) {
      const Eigen::Vector2d pixel(u, v);
      const std::optional<Eigen::Vector3d> bearing = lens().Unproject(pixel);
      if (!bearing) continue;
      EXPECT_NEAR(bearing->norm(), 1, 1e-12);
      const std::optional<Eigen::Vector2d> again = lens().Project(*bearing);
      ASSERT_TRUE(again.has_value()) << "at pixel " << pixel.transpose();
      max_error = std::max(max_error, (*again - pixel).norm());
      ++num_pixels;
    }
  }

  EXPECT_LE(max_error, 1e-9);
  EXPECT_GT(num_pixels,
            40'000);  // of 89,871: the image circle of a fisheye fills more than half of the image
}

TEST_P(EveryLens, UnprojectingAProjectedPointGivesItsBearingAndNothingFolds) {
  int num_valid = 0;
  for (const Eigen::Vector3d& bearing : Bearings(20'000)) {
    const std::optional<Eigen::Vector2d> pixel = lens().Project(3.0 * bearing);
    if (!pixel || !lens().IsInImage(*pixel, -200)) continue;
    const std::optional<Eigen::Vector3d> again = lens().Unproject(*pixel);
    ASSERT_TRUE(again.has_value())
        << "bearing " << bearing.transpose() << " pixel " << pixel->transpose();
    // A second bearing for the same pixel would mean a fold inside the domain. Close to a fold the
    // inverse is a square root, hence the tolerance.
    EXPECT_LT((*again - bearing).norm(), 1e-6) << "bearing " << bearing.transpose();
    ++num_valid;
  }

  EXPECT_GT(num_valid, 500);
}

TEST_P(EveryLens, SeesTheFieldThatItMust) {
  const double half_field = 0.5 * GetParam().min_field_deg * M_PI / 180;
  for (double around = 0; around < 6.28; around += 0.1) {
    const Eigen::Vector3d bearing(std::sin(half_field) * std::cos(around),
                                  std::sin(half_field) * std::sin(around), std::cos(half_field));
    EXPECT_TRUE(lens().Project(bearing).has_value()) << "around " << around;
  }
}

TEST_P(EveryLens, PixelsMoveOutwardsWithTheAngleUpToTheEndOfTheDomain) {
  for (double around = 0; around < 6.28; around += 0.2) {
    const Eigen::Vector2d center = lens().Project(Eigen::Vector3d::UnitZ()).value();
    double radius = 0;
    bool has_ended = false;
    for (double theta = 0.001; theta < M_PI; theta += 0.001) {
      const auto pixel = lens().Project({std::sin(theta) * std::cos(around),
                                         std::sin(theta) * std::sin(around), std::cos(theta)});
      if (!pixel) has_ended = true;
      if (!pixel || (*pixel - center).norm() > 1500) continue;
      EXPECT_FALSE(has_ended) << "a second domain at " << theta << " rad";
      EXPECT_GT((*pixel - center).norm(), radius) << "at " << theta << " rad";
      radius = (*pixel - center).norm();
    }
  }
}

TEST_P(EveryLens, JacobianMatchesFiniteDifferences) {
  std::vector<Eigen::Vector3d> points = Bearings(300);
  // On the axis and beside it, where the fisheyes switch to a series.
  for (const double x : {0.0, 1e-12, 1e-7, 5e-7, 2e-6, 1e-4}) points.emplace_back(x, -0.7 * x, 1);
  int num_valid = 0;
  for (Eigen::Vector3d point : points) {
    point *= 4;
    CameraModel::Jacobian jacobian;
    const std::optional<Eigen::Vector2d> pixel = lens().Project(point, &jacobian);
    ASSERT_EQ(pixel.has_value(), lens().Project(point).has_value());
    if (!pixel || !lens().IsInImage(*pixel)) continue;
    EXPECT_EQ(*pixel, *lens().Project(point));
    constexpr double kStep = 1e-5;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
      const auto after = lens().Project(point + step), before = lens().Project(point - step);
      if (!after || !before) continue;  // at the border of the domain
      const Eigen::Vector2d numeric = (*after - *before) / (2 * kStep);
      EXPECT_LT((jacobian.col(i) - numeric).norm(), 1e-5 * (1 + numeric.norm()))
          << "point " << point.transpose() << ", column " << i;
    }
    ++num_valid;
  }
  EXPECT_GE(num_valid, 6 + 10);
}

TEST_P(EveryLens, TheLengthOfThePointDoesNotMatter) {
  for (const Eigen::Vector3d& bearing : Bearings(500)) {
    const auto near = lens().Project(0.01 * bearing), far = lens().Project(1000.0 * bearing);
    ASSERT_EQ(near.has_value(), far.has_value());
    if (near && lens().IsInImage(*near)) {
      EXPECT_LT((*near - *far).norm(), 1e-9);
    }
  }
}

TEST_P(EveryLens, RefusesWhatIsNotAPoint) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(lens().Project(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(lens().Project(Eigen::Vector3d(0, 0, -1)));
  EXPECT_FALSE(lens().Project(Eigen::Vector3d(kNan, 0, 1)));
  EXPECT_FALSE(lens().Project(Eigen::Vector3d(0, 0, kNan)));
  EXPECT_FALSE(lens().Project(Eigen::Vector3d(kInfinity, 0, 1)));
  EXPECT_FALSE(lens().Unproject({kNan, 0}));
  EXPECT_FALSE(lens().Unproject({kInfinity, 0}));
}

TEST_P(EveryLens, AHalfSizeImageSeesTheSame) {
  const CameraModel half = lens().Scaled(0.5);
  EXPECT_EQ(half.width(), 640);
  EXPECT_EQ(half.height(), 480);
  for (const Eigen::Vector3d& bearing : Bearings(500)) {
    const auto full_pixel = lens().Project(bearing), half_pixel = half.Project(bearing);
    ASSERT_EQ(full_pixel.has_value(), half_pixel.has_value());
    if (!full_pixel || !lens().IsInImage(*full_pixel)) continue;
    // Area averaging: the center of half-size pixel 0 lies between the full-size pixels 0 and 1.
    EXPECT_LT((*full_pixel - (2 * *half_pixel + Eigen::Vector2d(0.5, 0.5))).norm(), 1e-9);
  }
}

// OpenCV as the second implementation.

std::vector<cv::Point3d> PointsInFront(double max_angle) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> around(0, 2 * M_PI), angle(0, max_angle), range(0.5, 20);
  std::vector<cv::Point3d> points = {{0, 0, 2}};
  for (int i = 0; i < 1000; ++i) {
    const double a = around(random), t = angle(random), r = range(random);
    points.emplace_back(r * std::sin(t) * std::cos(a), r * std::sin(t) * std::sin(a),
                        r * std::cos(t));
  }
  return points;
}

template <typename Projection>
void ExpectSamePixels(const Projection& lens, const std::vector<cv::Point3d>& points,
                      const std::vector<cv::Point2d>& expected) {
  ASSERT_EQ(points.size(), expected.size());
  for (size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector2d pixel;
    ASSERT_TRUE(lens.Project(Eigen::Vector3d(points[i].x, points[i].y, points[i].z), &pixel))
        << points[i];
    EXPECT_NEAR(pixel.x(), expected[i].x, 1e-9);
    EXPECT_NEAR(pixel.y(), expected[i].y, 1e-9);
  }
}

const cv::Vec3d kZero(0, 0, 0);

TEST(CameraProjections, RadTanAgreesWithOpenCvsProjectPoints) {
  const RadTanProjection lens{458, 457, 367, 248, {-0.283, 0.0739, 1.9e-4, 1.8e-5, -0.003}};
  const cv::Matx33d k(458, 0, 367, 0, 457, 248, 0, 0, 1);
  const std::vector<cv::Point3d> points = PointsInFront(0.8);
  std::vector<cv::Point2d> expected;
  cv::projectPoints(points, kZero, kZero, k,
                    cv::Vec<double, 5>(-0.283, 0.0739, 1.9e-4, 1.8e-5, -0.003), expected);

  ExpectSamePixels(lens, points, expected);
}

TEST(CameraProjections, KannalaBrandtAgreesWithOpenCvsFisheye) {
  const KannalaBrandtProjection lens{380, 381, 640, 480, -0.013, 0.021, -0.012, 0.0021};
  const cv::Matx33d k(380, 0, 640, 0, 381, 480, 0, 0, 1);
  const std::vector<cv::Point3d> points =
      PointsInFront(1.5);  // OpenCV's goes by x/z: below 90 degrees only
  std::vector<cv::Point2d> expected;
  cv::fisheye::projectPoints(points, expected, cv::Affine3d(), k,
                             cv::Vec4d(-0.013, 0.021, -0.012, 0.0021));

  ExpectSamePixels(lens, points, expected);
}

TEST(CameraProjections, MeiAgreesWithOpenCvsOmnidirBeyond180Degrees) {
  const MeiProjection lens{1.7, 850, 851, 640, 480, {-0.1, 0.2, 3e-4, -2e-4}};
  const cv::Matx33d k(850, 0, 640, 0, 851, 480, 0, 0, 1);
  const std::vector<cv::Point3d> points = PointsInFront(1.75);
  std::vector<cv::Point2d> expected;
  cv::omnidir::projectPoints(points, expected, kZero, kZero, k, 1.7,
                             cv::Vec4d(-0.1, 0.2, 3e-4, -2e-4));

  ExpectSamePixels(lens, points, expected);
}

// Relations between the models.

TEST(CameraProjections, EucmOfBetaOneIsMeiOfTheSameSphere) {
  const double alpha = 0.6, xi = alpha / (1 - alpha);
  const EucmProjection eucm{.alpha = alpha, .beta = 1, .fx = 300, .fy = 300, .cx = 640, .cy = 480};
  const MeiProjection mei{
      .xi = xi, .fx = 300 / (1 - alpha), .fy = 300 / (1 - alpha), .cx = 640, .cy = 480};
  const DoubleSphereProjection sphere{
      .xi = 0, .alpha = alpha, .fx = 300, .fy = 300, .cx = 640, .cy = 480};
  for (const cv::Point3d& p : PointsInFront(1.9)) {
    const Eigen::Vector3d point(p.x, p.y, p.z);
    Eigen::Vector2d a, b, c;
    ASSERT_TRUE(eucm.Project(point, &a) && mei.Project(point, &b) && sphere.Project(point, &c));
    EXPECT_LT((a - b).norm() + (a - c).norm(), 1e-9);
  }
}

TEST(CameraProjections, OcamPixelsLieOnTheRayOfItsPolynomial) {
  const OcamProjection lens{329, -1.6e-3, 1.1e-6, -1.9e-9, 640, 480, 0.9998, 4.9e-4, 2.4e-4};
  for (const double radius : {1e-9, 1.0, 100.0, 329.0, 400.0, 520.0}) {
    const double x = radius * std::cos(0.3), y = radius * std::sin(0.3);
    const double z = 329 - 1.6e-3 * radius * radius + 1.1e-6 * std::pow(radius, 3) -
                     1.9e-9 * std::pow(radius, 4);
    Eigen::Vector2d pixel;
    ASSERT_TRUE(lens.Project(Eigen::Vector3d(x, y, z), &pixel));
    EXPECT_NEAR(pixel.x(), 0.9998 * x + 4.9e-4 * y + 640, 1e-9);
    EXPECT_NEAR(pixel.y(), 2.4e-4 * x + y + 480, 1e-9);
  }
}

TEST(CameraProjections, ARadTanLensRefusesWhatItsFoldWouldPutBackIntoTheImage) {
  // r (1 - 0.4 r^2) turns at r = 0.913: the point at r = 1.5 would land at pixel radius 0.15 f.
  const RadTanProjection lens{700, 700, 640, 480, {-0.4}};
  Eigen::Vector2d pixel;
  EXPECT_TRUE(lens.Project(Eigen::Vector3d(0.91, 0, 1), &pixel));
  EXPECT_FALSE(lens.Project(Eigen::Vector3d(0.92, 0, 1), &pixel));
  EXPECT_FALSE(lens.Project(Eigen::Vector3d(1.5, 0, 1), &pixel));
}

TEST(CameraModel, PixelsPerRadianOfAnEquidistantLensFallsSidewaysAsSineOverAngle) {
  const CameraModel lens(KannalaBrandtProjection{400, 400, 640, 480}, 1280, 960);
  EXPECT_NEAR(lens.PixelsPerRadian({640, 480}).value(), 400, 1e-6);
  // One radian off the axis: 400 along the radius, 400 * 1 / sin(1) across.
  EXPECT_NEAR(lens.PixelsPerRadian({1040, 480}).value(), 0.5 * (400 + 400 / std::sin(1.0)), 1e-6);
}

TEST(CameraModel, RefusesIntrinsicsOutOfRangeAndNamesThem) {
  const auto message = [](CameraModel::Projection projection, int width,
                          int height) -> std::string {
    try {
      CameraModel(std::move(projection), width, height);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(message(PinholeProjection{-1, 400, 0, 0}, 640, 480).find("'fx'"), std::string::npos);
  EXPECT_NE(message(PinholeProjection{400, 400, NAN, 0}, 640, 480).find("'cx'"), std::string::npos);
  EXPECT_NE(message(EucmProjection{1.2, 1, 400, 400, 0, 0}, 640, 480).find("'alpha'"),
            std::string::npos);
  EXPECT_NE(message(MeiProjection{-1, 400, 400, 0, 0, {}}, 640, 480).find("'xi'"),
            std::string::npos);
  EXPECT_NE(message(OcamProjection{.a0 = -300}, 640, 480).find("'a0'"), std::string::npos);
  EXPECT_NE(message(KannalaBrandtProjection{400, 400, 0, 0, INFINITY}, 640, 480).find("'k1'"),
            std::string::npos);
  EXPECT_NE(message(PinholeProjection{400, 400, 0, 0}, 0, 480).find("image size"),
            std::string::npos);
}

}  // namespace
}  // namespace parkade

#include "mapping/evaluation/surface_picture.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "tests/mapping/worlds/test_surfaces.h"

namespace parkade {
namespace {

TriangleMesh Rectangle(double x0, double y0, double x1, double y1) {
  TriangleMesh mesh;
  AddRectangle(mesh, x0, y0, x1, y1, 0);
  return mesh;
}

bool IsGray(const cv::Vec3b& color) { return color[0] == color[1] && color[1] == color[2]; }

TEST(PaintSurfaceErrors, ShowsWhatIsMissedAndWhatIsFalse) {
  const SurfaceEvaluationOptions options;
  const ScopedSurfaces surfaces =
      ScopeSurfaces(Rectangle(0, 0, 20, 10), Rectangle(2, 0, 22, 10), options, {});

  const cv::Mat picture = PaintSurfaceErrors(surfaces, 0.5, options);

  ASSERT_EQ(picture.size(), cv::Size(220, 100));
  const auto at = [&](double x, double y) {
    return picture.at<cv::Vec3b>(100 - 1 - static_cast<int>(10 * y), static_cast<int>(10 * x));
  };
  const cv::Vec3b missed = at(1, 5), wrong = at(21, 5), only_estimated = at(2.2, 5);
  EXPECT_GT(missed[0], missed[2] + 100) << "blue";
  EXPECT_GT(wrong[2], wrong[0] + 100) << "red";
  EXPECT_GT(only_estimated[2], only_estimated[0]) << "orange";
  EXPECT_GT(only_estimated[1], wrong[1] + 50) << "orange";
  EXPECT_TRUE(IsGray(at(11, 5)));
  EXPECT_LT(at(11, 0.2)[0], at(11, 5)[0]) << "outlines of both are darker";
}

TEST(PaintSurfaceErrors, NorthIsUpAndWhatDoesNotCountIsWhite) {
  const SurfaceEvaluationOptions options;
  const std::vector<Eigen::Vector3d> path = {{5, 20, 0}};
  SurfaceScope scope;
  scope.path = path;
  const ScopedSurfaces surfaces =
      ScopeSurfaces(Rectangle(0, 0, 10, 20), Rectangle(0, 0, 10, 20), options, scope);

  const cv::Mat picture = PaintSurfaceErrors(surfaces, 0.5, options);

  ASSERT_LT(picture.rows, 130) << "12 m of the path";
  EXPECT_NE(picture.at<cv::Vec3b>(5, 50), cv::Vec3b(255, 255, 255)) << "beside the path";
  EXPECT_EQ(picture.at<cv::Vec3b>(picture.rows - 2, 1), cv::Vec3b(255, 255, 255)) << "13 m off";
}

}  // namespace
}  // namespace parkade

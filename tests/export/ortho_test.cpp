#include "export/ortho.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <sstream>

namespace parkade {
namespace {

SurfaceCell CellAt(int x, int y, float height, std::array<std::uint8_t, 3> color) {
  SurfaceCell cell;
  cell.x = x;
  cell.y = y;
  cell.height = height;
  cell.color = color;
  return cell;
}

cv::Mat Decode(const Orthophoto& ortho) {
  const std::string png = EncodePng(ortho);
  const std::vector<char> bytes(png.begin(), png.end());
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

/// The pixel that shows a place of the site, by the world file.
cv::Point PixelOf(const Orthophoto& ortho, double x, double y) {
  std::istringstream text(EncodeWorldFile(ortho));
  double a = 0, d = 0, b = 0, e = 0, c = 0, f = 0;
  text >> a >> d >> b >> e >> c >> f;
  return {static_cast<int>(std::lround((x - c) / a)), static_cast<int>(std::lround((y - f) / e))};
}

TEST(Orthophoto, EveryCellIsWhereTheWorldFileSays) {
  SurfaceMap surface;
  surface.cell_size = 0.1;
  surface.cells = {CellAt(-7, -3, 0, {255, 0, 0}), CellAt(4, -3, 0, {0, 255, 0}),
                   CellAt(0, 5, 0, {0, 0, 255})};

  const Orthophoto ortho = RenderOrthophoto(surface);
  const cv::Mat image = Decode(ortho);

  ASSERT_EQ(image.size(), cv::Size(12, 9));
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, -0.65, -0.25)), cv::Vec4b(0, 0, 255, 255));  // BGRA
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, 0.45, -0.25)), cv::Vec4b(0, 255, 0, 255));
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, 0.05, 0.55)), cv::Vec4b(255, 0, 0, 255));
  EXPECT_EQ(PixelOf(ortho, 0.05, 0.55).y, 0);                         // north is up
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, -0.05, 0.05))[3], 0);  // unknown is transparent
}

TEST(Orthophoto, OfATextureShowsEveryTexelWhereItIsAndTheHigherChartOnTop) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  GroundTexture texture{0.5, 16, {}};
  const auto add = [&](double left, double top, std::uint32_t triangle, const cv::Scalar& color) {
    TextureChart& chart = texture.charts.emplace_back();
    chart.left = left;
    chart.top = top;
    chart.triangles = {triangle};
    chart.image = cv::Mat(4, 4, CV_8UC3, color);
    chart.mask = cv::Mat(4, 4, CV_8UC1, cv::Scalar(255));
    chart.mask.at<std::uint8_t>(0, 0) = 0;
  };
  add(-2, 1, 0, {10, 20, 30});  // the upper deck, x -2..0, y -1..1
  add(-1, 2, 1, {40, 50, 60});  // the lower one, x -1..1, y 0..2

  const Orthophoto ortho = RenderOrthophoto(mesh, texture);
  const cv::Mat image = Decode(ortho);

  ASSERT_EQ(image.size(), cv::Size(6, 6));
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, -0.25, 0.25)), cv::Vec4b(10, 20, 30, 255))
      << "both decks";
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, 0.75, 0.25)), cv::Vec4b(40, 50, 60, 255));
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, -1.25, -0.75)), cv::Vec4b(10, 20, 30, 255));
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, -1.75, 0.75))[3], 0) << "off the mesh";
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, 0.75, -0.75))[3], 0) << "unknown";
}

TEST(Orthophoto, TheHighestDeckIsSeen) {
  SurfaceMap surface;
  surface.cells = {CellAt(0, 0, 0, {10, 10, 10}), CellAt(0, 0, 2.8F, {200, 200, 200})};
  EXPECT_EQ(Decode(RenderOrthophoto(surface)).at<cv::Vec4b>(0, 0), cv::Vec4b(200, 200, 200, 255));
}

TEST(Orthophoto, AVeryLargeSiteGetsLargerPixels) {
  SurfaceMap surface;
  surface.cell_size = 0.1;
  surface.cells = {CellAt(-501, -3, 0, {255, 0, 0}), CellAt(499, 7, 0, {0, 255, 0})};

  const Orthophoto ortho = RenderOrthophoto(surface, 200);
  const cv::Mat image = Decode(ortho);

  EXPECT_LE(image.cols, 201);
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, -50.05, -0.25)), cv::Vec4b(0, 0, 255, 255));
  EXPECT_EQ(image.at<cv::Vec4b>(PixelOf(ortho, 49.95, 0.75)), cv::Vec4b(0, 255, 0, 255));
}

TEST(Orthophoto, AnEmptyMapIsOneTransparentPixel) {
  const cv::Mat image = Decode(RenderOrthophoto({}));
  ASSERT_EQ(image.size(), cv::Size(1, 1));
  EXPECT_EQ(image.at<cv::Vec4b>(0, 0)[3], 0);
}

}  // namespace
}  // namespace parkade

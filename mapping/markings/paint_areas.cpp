#include "mapping/markings/paint_areas.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace parkade {
namespace {

constexpr double kWidestStroke = 0.7;  // [m] brighter spots that are wider than this are no paint
constexpr double kMinContrast = 0.3;   // against the ground around, of its brightness
constexpr double kMinArea = 0.12;      // [m^2]
constexpr double kMaxArea = 15;        // [m^2]
constexpr double kPixel = 0.04;        // [m] at which areas are looked for
constexpr double kRim = 0.3;     // [m] of known ground around a piece: smears of cars have none
constexpr double kThinnest = 7;  // length over width of what is a line
constexpr float kDarkness = 12;  // of 255
constexpr double kOutlineError = 0.03;  // [m]
constexpr int kYellow = 40;             // of 255 by which blue falls behind

bool IsYellow(const cv::Mat& image, const cv::Mat& piece) {
  const cv::Scalar mean = cv::mean(image, piece);
  return std::min(mean[1], mean[2]) - mean[0] > kYellow;
}

/// Whether a piece is as thin all along as a stripe is.
bool IsLine(const std::vector<cv::Point>& contour, double area) {
  const cv::RotatedRect box = cv::minAreaRect(contour);
  const double length = std::max(box.size.width, box.size.height) + 1, width = area / length;
  return length > kThinnest * width &&
         area > 0.5 * length * (std::min(box.size.width, box.size.height) + 1);
}

}  // namespace

std::vector<PaintArea> FindPaintAreas(const GroundTile& tile) {
  const double scale = tile.pixel_size / kPixel;
  cv::Mat image, mask, brightness, opened, inside, paint;
  cv::resize(tile.image, image, {}, scale, scale, cv::INTER_AREA);
  cv::resize(tile.mask == GroundTile::kSure, mask, image.size(), 0, 0, cv::INTER_NEAREST);
  cv::transform(image, brightness, cv::Matx13f(0.0F, 0.5F, 0.5F));
  brightness.convertTo(brightness, CV_32FC1);
  const auto disc = [](double diameter) {
    const int size = 2 * static_cast<int>(std::lround(0.5 * diameter / kPixel)) + 1;
    return cv::getStructuringElement(cv::MORPH_ELLIPSE, {size, size});
  };
  cv::morphologyEx(brightness, opened, cv::MORPH_OPEN, disc(kWidestStroke));
  cv::erode(mask, inside, disc(2 * kRim), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  paint = (brightness - opened) > kMinContrast * (opened + kDarkness);
  cv::morphologyEx(paint, paint, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));

  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(paint, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::vector<PaintArea> areas;
  for (const std::vector<cv::Point>& contour : contours) {
    const cv::Rect box = cv::boundingRect(contour);
    if (box.area() * kPixel * kPixel < kMinArea) continue;
    cv::Mat piece = cv::Mat::zeros(box.size(), CV_8UC1);
    cv::drawContours(piece, std::vector<std::vector<cv::Point>>{contour}, 0, 255, cv::FILLED,
                     cv::LINE_8, {}, 0, -box.tl());
    cv::bitwise_and(piece, paint(box), piece);
    const double area = cv::countNonZero(piece), square_meters = area * kPixel * kPixel;
    if (square_meters < kMinArea || square_meters > kMaxArea || IsLine(contour, area)) continue;
    if (cv::countNonZero(piece & ~inside(box)) > 0) continue;
    PaintArea found{{}, tile.height, IsYellow(image(box), piece)};
    std::vector<cv::Point> outline;
    cv::approxPolyDP(contour, outline, kOutlineError / kPixel, true);
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const cv::Point& point : outline) {
      found.outline.emplace_back(
          tile.PlaceOf((point.x + 0.5) / scale - 0.5, (point.y + 0.5) / scale - 0.5));
      middle += found.outline.back() / static_cast<double>(outline.size());
    }
    if (outline.size() >= 3 && tile.core.contains(middle)) areas.push_back(std::move(found));
  }
  return areas;
}

}  // namespace parkade

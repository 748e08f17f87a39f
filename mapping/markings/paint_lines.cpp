#include "mapping/markings/paint_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "mapping/markings/axis_aligned_lines.h"

namespace parkade {
namespace {

constexpr int kMaxDirections = 4;         // that one neighborhood may have
constexpr double kDirectionPixel = 0.05;  // [m] at which directions are looked for
constexpr double kWidestPaint = 0.26;   // [m] brighter spots that are wider than this are no lines
constexpr float kEdgeContrast = 0.08F;  // of spots whose edges count
constexpr float kDarkness = 10;         // of 255: in the dark contrast is noise
constexpr double kLeastDirection = 0.15;  // of the strongest one's edges
constexpr int kMinDirectionApart = 6;     // [deg]
constexpr double kSameLine = 0.1;         // [m] aside
constexpr double kSameDirection = 4;      // [deg]
constexpr int kYellow = 40;               // of 255 by which blue falls behind

/// Red and green: white and yellow paint are bright in both.
cv::Mat BrightnessOf(const cv::Mat& image) {
  cv::Mat brightness;
  cv::transform(image, brightness, cv::Matx13f(0.0F, 0.5F, 0.5F));
  brightness.convertTo(brightness, CV_32FC1);
  return brightness;
}

/// Weight of edges around bright narrow spots by the direction [deg] of their normals, smoothed.
std::vector<float> EdgeDirections(const cv::Mat& brightness, const cv::Mat& mask,
                                  double pixel_size) {
  cv::Mat smooth, opened, is_known, gx, gy, contrast;
  cv::GaussianBlur(brightness, smooth, {}, 0.03 / pixel_size);
  const int spot = 2 * static_cast<int>(std::lround(0.5 * kWidestPaint / pixel_size)) + 1;
  cv::morphologyEx(smooth, opened, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {spot, spot}));
  contrast = (smooth - opened) / (smooth + kDarkness);
  cv::dilate(contrast, contrast, cv::Mat::ones(3, 3, CV_8U));
  cv::erode(mask, is_known, cv::Mat::ones(5, 5, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT,
            cv::Scalar::all(0));
  cv::Sobel(smooth, gx, CV_32FC1, 1, 0);
  cv::Sobel(smooth, gy, CV_32FC1, 0, 1);
  std::vector<float> raw(180), directions(180);
  for (int row = 0; row < smooth.rows; ++row)
    for (int column = 0; column < smooth.cols; ++column) {
      if (is_known.at<std::uint8_t>(row, column) == 0 ||
          contrast.at<float>(row, column) < kEdgeContrast)
        continue;
      const float x = gx.at<float>(row, column), y = gy.at<float>(row, column);
      const double degrees =
          std::atan2(static_cast<double>(-y), static_cast<double>(x)) * 180 / std::numbers::pi;
      const int bin = (static_cast<int>(std::floor(degrees)) % 180 + 180) % 180;
      raw[static_cast<std::size_t>(bin)] +=
          std::hypot(x, y) / (smooth.at<float>(row, column) + kDarkness);
    }
  for (std::size_t i = 0; i < 180; ++i)
    directions[i] = 0.25F * raw[(i + 179) % 180] + 0.5F * raw[i] + 0.25F * raw[(i + 1) % 180];
  return directions;
}

/// [rad] directions that lines may have, the most frequent first.
std::vector<double> FindDirections(const cv::Mat& brightness, const cv::Mat& mask,
                                   double pixel_size, int max_count) {
  const double scale = pixel_size / kDirectionPixel;
  cv::Mat small, small_mask;
  cv::resize(brightness, small, {}, scale, scale, cv::INTER_AREA);
  cv::resize(mask, small_mask, small.size(), 0, 0, cv::INTER_NEAREST);
  const std::vector<float> weights = EdgeDirections(small, small_mask, kDirectionPixel);
  std::vector<int> order(180), chosen;
  for (int i = 0; i < 180; ++i) order[static_cast<std::size_t>(i)] = i;
  const auto weight = [&](int degrees) {
    return weights[static_cast<std::size_t>((degrees + 180) % 180)];
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return weight(a) > weight(b); });
  for (const int degrees : order) {
    if (static_cast<int>(chosen.size()) >= max_count) break;
    const bool is_peak =
        weight(degrees) >= weight(degrees - 1) && weight(degrees) >= weight(degrees + 1);
    if (!is_peak || !(weight(degrees) > 0) || weight(degrees) < kLeastDirection * weight(order[0]))
      continue;
    const bool is_new = std::none_of(chosen.begin(), chosen.end(), [&](int other) {
      const int apart = std::abs(degrees - other);
      return std::min(apart, 180 - apart) < kMinDirectionApart;
    });
    if (is_new) chosen.push_back(degrees);
  }
  std::vector<double> directions;  // of the lines: square to the normals of their edges
  directions.reserve(chosen.size());
  for (const int degrees : chosen) directions.push_back((degrees + 90.5) * std::numbers::pi / 180);
  return directions;
}

bool IsYellowAt(const GroundTile& tile, const Eigen::Vector2d& begin, const Eigen::Vector2d& end) {
  constexpr int kNumSamples = 21;
  int sum = 0, count = 0;
  for (int i = 0; i < kNumSamples; ++i) {
    const Eigen::Vector2d place = begin + (i + 0.5) / kNumSamples * (end - begin);
    const int column = static_cast<int>(std::floor((place.x() - tile.left) / tile.pixel_size));
    const int row = static_cast<int>(std::floor((tile.top - place.y()) / tile.pixel_size));
    if (column < 0 || row < 0 || column >= tile.image.cols || row >= tile.image.rows) continue;
    if (tile.mask.at<std::uint8_t>(row, column) == 0) continue;
    const cv::Vec3b& bgr = tile.image.at<cv::Vec3b>(row, column);
    sum += std::min(bgr[1], bgr[2]) - bgr[0];
    ++count;
  }
  return count > 0 && sum > kYellow * count;
}

/// True where `line` is a part of one of `lines`: directions that lie near each other find the same
/// ones.
bool IsKnown(const PaintLine& line, const std::vector<PaintLine>& lines) {
  const double min_cosine = std::cos(kSameDirection * std::numbers::pi / 180);
  return std::any_of(lines.begin(), lines.end(), [&](const PaintLine& other) {
    const Eigen::Vector2d direction = other.Direction(), to_middle = line.Middle() - other.begin;
    const double along = to_middle.dot(direction);
    const double aside = std::abs(to_middle.x() * direction.y() - to_middle.y() * direction.x());
    return std::abs(line.Direction().dot(direction)) > min_cosine && aside < kSameLine &&
           along > -kSameLine && along < other.Length() + kSameLine;
  });
}

}  // namespace

std::vector<PaintLine> FindPaintLines(const GroundTile& tile, const PaintLineOptions& options) {
  options.Validate();
  const cv::Mat brightness = BrightnessOf(tile.image);
  std::vector<PaintLine> lines;
  const cv::Mat sure = tile.mask == GroundTile::kSure;
  const double reach = std::max(options.filter_length, 2 * options.stripe_width);
  for (const double direction : FindDirections(brightness, sure, tile.pixel_size, kMaxDirections)) {
    const RotatedRaster turned(brightness, tile.mask, tile.pixel_size, direction,
                               options.pixel_size, reach);
    std::vector<PaintLine> found;
    for (const AxisAlignedLine& upright : FindAxisAlignedLines(turned, options)) {
      const auto place = [&](double row) -> Eigen::Vector2d {
        const Eigen::Vector2d pixel = turned.SourceOf(upright.ColumnAt(row), row);
        return tile.PlaceOf(pixel.x(), pixel.y());
      };
      PaintLine line{.begin = place(upright.first_row),
                     .end = place(upright.last_row),
                     .height = tile.height,
                     .width = upright.width * options.pixel_size,
                     .contrast = upright.contrast,
                     .is_begin_seen = upright.is_first_seen,
                     .is_end_seen = upright.is_last_seen,
                     .is_yellow = false,
                     .is_one_sided = upright.is_one_sided};
      if (line.Length() < kMinLineLength || !tile.core.contains(line.Middle()) ||
          IsKnown(line, lines))
        continue;
      line.is_yellow = IsYellowAt(tile, line.begin, line.end);
      found.push_back(line);
    }
    lines.insert(lines.end(), found.begin(), found.end());
  }
  return lines;
}

}  // namespace parkade

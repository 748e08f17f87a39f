#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <random>
#include <utility>
#include <vector>

#include "mapping/markings/ground_tiles.h"

namespace parkade {

/// A tile of noisy gray ground about (0, 0), to be painted on.
class PaintedGround {
 public:
  explicit PaintedGround(double side = 30, double pixel_size = 0.02, double noise = 6) {
    const int pixels = static_cast<int>(std::lround(side / pixel_size));
    tile_.pixel_size = pixel_size;
    tile_.left = -0.5 * side, tile_.top = 0.5 * side;
    tile_.image = cv::Mat(pixels, pixels, CV_8UC3, cv::Scalar::all(110));
    tile_.mask = cv::Mat(pixels, pixels, CV_8UC1, cv::Scalar::all(255));
    tile_.core = Eigen::AlignedBox2d(Eigen::Vector2d::Constant(-0.5 * side),
                                     Eigen::Vector2d::Constant(0.5 * side));
    std::mt19937 random(7);
    for (int row = 0; row < pixels; ++row)
      for (int column = 0; column < pixels; ++column) {
        // Sums of few bits instead of a distribution: the same with every library.
        const int value =
            110 + static_cast<int>(noise * (static_cast<int>(random() % 101) - 50) / 50);
        tile_.image.at<cv::Vec3b>(row, column) = cv::Vec3b::all(static_cast<std::uint8_t>(value));
      }
  }

  /// A stripe; of worn ones only every so many of its pieces of 0.2 m are left.
  void Line(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, double width = 0.12,
            const cv::Scalar& color = cv::Scalar::all(215), int keeps_one_of = 1) {
    const double length = (end - begin).norm();
    const Eigen::Vector2d along = (end - begin) / length, across(-along.y(), along.x());
    const int pieces = static_cast<int>(std::ceil(length / 0.2));
    for (int i = 0; i < pieces; i += keeps_one_of) {
      const Eigen::Vector2d from = begin + along * (0.2 * i),
                            to = begin + along * std::min(0.2 * (i + 1), length);
      Polygon({from - 0.5 * width * across, to - 0.5 * width * across, to + 0.5 * width * across,
               from + 0.5 * width * across},
              color);
    }
  }

  void Polygon(const std::vector<Eigen::Vector2d>& points, const cv::Scalar& color) {
    std::vector<cv::Point> pixels;
    for (const Eigen::Vector2d& point : points) pixels.push_back(Fixed(point));
    cv::fillPoly(tile_.image, std::vector<std::vector<cv::Point>>{pixels}, color, cv::LINE_AA,
                 kShift);
  }

  /// A shadow that leaves this share of the light.
  void Shade(const std::vector<Eigen::Vector2d>& points, double share) {
    std::vector<cv::Point> pixels;
    for (const Eigen::Vector2d& point : points) pixels.push_back(Fixed(point));
    cv::Mat mask(tile_.image.size(), CV_8UC1, cv::Scalar::all(0));
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{pixels}, cv::Scalar::all(255),
                 cv::LINE_8, kShift);
    const cv::Mat shaded = share * tile_.image;
    shaded.copyTo(tile_.image, mask);
  }

  /// What stands there hides the ground.
  void Hide(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    cv::rectangle(tile_.mask, Pixel(low), Pixel(high), cv::Scalar::all(0), cv::FILLED);
  }

  const GroundTile& tile() const { return tile_; }

 private:
  static constexpr int kShift = 4;  // bits of a pixel's fraction

  cv::Point2d Place(const Eigen::Vector2d& point) const {
    return {(point.x() - tile_.left) / tile_.pixel_size - 0.5,
            (tile_.top - point.y()) / tile_.pixel_size - 0.5};
  }
  cv::Point Fixed(const Eigen::Vector2d& point) const {
    const cv::Point2d place = Place(point);
    return {static_cast<int>(std::lround(place.x * (1 << kShift))),
            static_cast<int>(std::lround(place.y * (1 << kShift)))};
  }
  cv::Point Pixel(const Eigen::Vector2d& point) const {
    const cv::Point2d place = Place(point);
    return {static_cast<int>(std::lround(place.x)), static_cast<int>(std::lround(place.y))};
  }

  GroundTile tile_;
};

}  // namespace parkade

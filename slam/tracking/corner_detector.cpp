#include "slam/tracking/corner_detector.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/tracking/corner_scores.h"

namespace parkade {
namespace {

constexpr float kMinScore =
    12;  ///< [(gray levels / px)^2] of the normalized image; sensor noise stays below
constexpr float kMinShareOfBest = 0.1f;  ///< of the best score in the cell
constexpr size_t kMaxPerCell = 4;
constexpr int kMaxDetectionWidth = 960;  ///< [px] wider images are searched at half size

struct Corner {
  Eigen::Vector2d pixel;
  float score = 0;
};

/// Which spots are taken, on the lattice of the scores.
class Occupancy {
 public:
  Occupancy(cv::Size size, double pixels_per_entry, double radius)
      : taken_(cv::Mat::zeros(size, CV_8UC1)),
        pixels_per_entry_(pixels_per_entry),
        radius_(radius) {}

  void Take(const Eigen::Vector2d& pixel) {
    cv::circle(taken_, EntryOf(pixel), static_cast<int>(std::ceil(radius_ / pixels_per_entry_)),
               255, cv::FILLED);
  }

  bool IsTaken(const Eigen::Vector2d& pixel) const {
    const cv::Point entry = EntryOf(pixel);
    return !cv::Rect({}, taken_.size()).contains(entry) || taken_.at<std::uint8_t>(entry) != 0;
  }

 private:
  cv::Point EntryOf(const Eigen::Vector2d& pixel) const {
    return {static_cast<int>(pixel.x() / pixels_per_entry_),
            static_cast<int>(pixel.y() / pixels_per_entry_)};
  }

  cv::Mat taken_;
  double pixels_per_entry_ = 1;
  double radius_ = 0;
};

/// The scores of an image, and where they peak.
struct ScoredImage {
  cv::Mat scores, is_peak;
};

bool AreZero8(const std::uint8_t* bytes) {
  std::uint64_t word;
  std::memcpy(&word, bytes, sizeof word);
  return word == 0;
}

/// The best few corners of one cell, best first.
std::vector<Corner> BestOfCell(const ScoredImage& image, const cv::Rect& cell,
                               const cv::Mat& usable, int spacing) {
  std::vector<Corner> corners;
  for (int y = cell.y; y < cell.br().y; ++y) {
    const auto* is_peak = image.is_peak.ptr<std::uint8_t>(y);
    for (int x = cell.x; x < cell.br().x; ++x) {
      if (x + 8 <= cell.br().x && AreZero8(is_peak + x)) {
        x += 7;
        continue;
      }
      if (is_peak[x] == 0) continue;
      const float score = image.scores.at<float>(y, x);
      const Eigen::Vector2d pixel(x * spacing, y * spacing);
      if (usable.at<std::uint8_t>(y * spacing, x * spacing) == 0) continue;
      corners.push_back({pixel, score});
    }
  }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.score > b.score; });
  if (corners.size() > kMaxPerCell) corners.resize(kMaxPerCell);
  while (!corners.empty() && corners.back().score < kMinShareOfBest * corners.front().score)
    corners.pop_back();
  return corners;
}

}  // namespace

CornerDetector::CornerDetector(const cv::Mat& usable, int max_corners) : max_corners_(max_corners) {
  const double area = std::max(1, cv::countNonZero(usable));
  cell_size_ = std::max(8, static_cast<int>(std::sqrt(area / max_corners)) / 4 * 4);
}

std::vector<Eigen::Vector2d> CornerDetector::Detect(
    const std::vector<cv::Mat>& pyramid, const cv::Mat& usable,
    const std::vector<Eigen::Vector2d>& present,
    const std::function<bool(const Eigen::Vector2d&)>& is_wanted) const {
  const auto wanted =
      static_cast<size_t>(std::max<std::ptrdiff_t>(0, max_corners_ - std::ssize(present)));
  std::vector<Eigen::Vector2d> found;
  if (wanted == 0) return found;
  const bool at_half_size = usable.cols > kMaxDetectionWidth && pyramid.size() > 1;
  const int spacing = at_half_size ? 2 * kCornerBlock : kCornerBlock;
  const cv::Mat scores = CornerScores(pyramid[at_half_size ? 1 : 0]);

  Occupancy occupancy(scores.size(), spacing, min_distance());
  const int cell = cell_size_ / spacing;
  const int columns = (scores.cols + cell - 1) / cell, rows = (scores.rows + cell - 1) / cell;
  std::vector<size_t> num_in_cell(static_cast<size_t>(columns * rows), 0);
  const auto cell_of = [&](const Eigen::Vector2d& pixel) {
    const int column = std::clamp(static_cast<int>(pixel.x()) / cell_size_, 0, columns - 1);
    const int row = std::clamp(static_cast<int>(pixel.y()) / cell_size_, 0, rows - 1);
    return static_cast<size_t>(row * columns + column);
  };
  for (const Eigen::Vector2d& pixel : present) {
    occupancy.Take(pixel);
    ++num_in_cell[cell_of(pixel)];
  }

  const cv::Rect inside(1, 1, std::min(scores.cols, usable.cols / spacing) - 2,
                        std::min(scores.rows, usable.rows / spacing) - 2);
  const ScoredImage image{scores, FindPeaks(scores, kMinScore)};
  std::vector<Corner> candidates;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (const Corner& corner : BestOfCell(
               image, cv::Rect(column * cell, row * cell, cell, cell) & inside, usable, spacing))
        candidates.push_back(corner);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Corner& a, const Corner& b) { return a.score > b.score; });

  for (size_t per_cell = 1; per_cell <= kMaxPerCell && found.size() < wanted; ++per_cell) {
    for (const Corner& corner : candidates) {
      if (found.size() == wanted) break;
      size_t& count = num_in_cell[cell_of(corner.pixel)];
      if (count >= per_cell || occupancy.IsTaken(corner.pixel)) continue;
      occupancy.Take(corner.pixel);
      if (!is_wanted(corner.pixel)) continue;
      ++count;
      found.push_back(corner.pixel);
    }
  }
  return found;
}

}  // namespace parkade

#include "slam/tracking/lucas_kanade.h"

#include <algorithm>
#include <cmath>
#include <opencv2/video/tracking.hpp>

namespace parkade {
namespace {

constexpr int kMaxIterations = 20;     ///< per level
constexpr double kConvergence = 0.02;  ///< [px]
constexpr double kNearPrediction = 3;  ///< [px] within which the way back needs no coarse levels
constexpr int kLevelsNear = 2;         ///< of the pyramid, that the way back needs then

using Points = std::vector<cv::Point2f>;

cv::Point2f ToPoint(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

/// One pass; `at` holds the starts and then what was found.
std::vector<std::uint8_t> Follow(const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
                                 const Points& points, Points& at, int window, int num_levels) {
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMaxIterations,
                                  kConvergence);
  const int top_level = std::min(num_levels, static_cast<int>(to.size() / 2)) - 1;
  std::vector<std::uint8_t> is_found;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(from, to, points, at, is_found, error, {window, window}, top_level,
                           criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  return is_found;
}

}  // namespace

std::vector<std::optional<Eigen::Vector2d>> FollowThereAndBack(
    const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
    const std::vector<Eigen::Vector2d>& before,
    const std::vector<std::optional<Eigen::Vector2d>>& start, const LucasKanadeOptions& options) {
  constexpr int kAllLevels = 100;
  std::vector<std::optional<Eigen::Vector2d>> found(before.size());
  std::vector<size_t> origins;
  Points points, after;
  for (size_t i = 0; i < before.size(); ++i) {
    if (!start[i]) continue;
    origins.push_back(i);
    points.push_back(ToPoint(before[i]));
    after.push_back(ToPoint(*start[i]));
  }
  if (origins.empty()) return found;
  const std::vector<std::uint8_t> is_found =
      Follow(from, to, points, after, options.window, kAllLevels);

  // The way back starts as far off as the prediction was, so that it proves something.
  for (const bool is_near : {true, false}) {
    std::vector<size_t> indices;
    Points goals, back;
    for (size_t i = 0; i < origins.size(); ++i) {
      const cv::Point2f off = after[i] - ToPoint(*start[origins[i]]);
      if (is_found[i] == 0 || (cv::norm(off) < kNearPrediction) != is_near) continue;
      indices.push_back(i);
      goals.push_back(after[i]);
      back.push_back(points[i] + off);
    }
    if (indices.empty()) continue;
    const auto returned =
        Follow(to, from, goals, back, options.window, is_near ? kLevelsNear : kAllLevels);
    for (size_t k = 0; k < indices.size(); ++k) {
      const size_t i = indices[k];
      if (returned[k] != 0 && cv::norm(back[k] - points[i]) <= options.max_round_trip)
        found[origins[i]] = Eigen::Vector2d(after[i].x, after[i].y);
    }
  }
  return found;
}

}  // namespace parkade

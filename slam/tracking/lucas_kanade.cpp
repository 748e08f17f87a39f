#include "slam/tracking/lucas_kanade.h"

#include <algorithm>
#include <cmath>

#include "slam/tracking/flow_patch.h"

namespace parkade {
namespace {

constexpr int kMaxIterations = 20;     ///< per level
constexpr double kConvergence = 0.02;  ///< [px] on the image itself
constexpr double kCoarse = 0.1;        ///< [px] on smaller levels, which only start the next
constexpr double kNearPrediction = 3;  ///< [px] within which the way back needs no coarse levels
constexpr size_t kLevelsNear = 2;      ///< of the pyramid, that the way back needs then

cv::Point2f ToPoint(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

double Norm(const cv::Point2f& step) {
  const double x = step.x, y = step.y;
  return std::sqrt(x * x + y * y);
}

/// From `at` [px of this level] to where the patch is, until a step is shorter than `convergence`
/// [px]; nothing where that leaves the image.
std::optional<cv::Point2f> Converge(const FlowPatch& patch, const cv::Mat& image, cv::Point2f at,
                                    double convergence) {
  constexpr float kSame = 0.01f;  // [px] two steps to and fro
  cv::Point2f last;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const std::optional<cv::Point2f> step = patch.StepFrom(image, at);
    if (!step) return std::nullopt;
    at += *step;
    if (Norm(*step) <= convergence) break;
    if (iteration > 0 && std::abs(step->x + last.x) < kSame && std::abs(step->y + last.y) < kSame) {
      at -= 0.5f * *step;
      break;
    }
    last = *step;
  }
  return patch.IsInside(image, at) ? std::optional(at) : std::nullopt;
}

/// From the coarsest of `num_levels` levels, near `start`, down to the image itself.
std::optional<cv::Point2f> Follow(const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
                                  const cv::Point2f& point, const cv::Point2f& start,
                                  size_t num_levels, FlowPatch& patch) {
  cv::Point2f at = start;  // [px] of the image itself
  for (size_t level = std::min({num_levels, from.size(), to.size()}); level-- > 0;) {
    const float scale = 1.0f / static_cast<float>(1 << level);
    const bool is_textured = patch.Take(from[level], scale * point);
    const std::optional<cv::Point2f> found =
        is_textured ? Converge(patch, to[level], scale * at, level == 0 ? kConvergence : kCoarse)
                    : std::nullopt;
    if (found) at = *found / scale;
    if (!found && level == 0) return std::nullopt;
  }
  return at;
}

/// There, and back with an error of at most `max_round_trip` [px].
std::optional<cv::Point2f> FollowThereAndBack(const std::vector<cv::Mat>& from,
                                              const std::vector<cv::Mat>& to,
                                              const cv::Point2f& point, const cv::Point2f& start,
                                              double max_round_trip, FlowPatch& patch) {
  const std::optional<cv::Point2f> there = Follow(from, to, point, start, from.size(), patch);
  if (!there) return std::nullopt;
  // The way back starts as far off as the prediction was, so that it proves something.
  const cv::Point2f off = *there - start;
  const size_t num_levels = Norm(off) < kNearPrediction ? kLevelsNear : to.size();
  const std::optional<cv::Point2f> back = Follow(to, from, *there, point + off, num_levels, patch);
  return back && Norm(*back - point) <= max_round_trip ? there : std::nullopt;
}

}  // namespace

std::vector<std::optional<Eigen::Vector2d>> FollowThereAndBack(
    const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
    const std::vector<Eigen::Vector2d>& before,
    const std::vector<std::optional<Eigen::Vector2d>>& start, const LucasKanadeOptions& options) {
  std::vector<std::optional<Eigen::Vector2d>> found(before.size());
  FlowPatch patch(options.window);
  for (size_t i = 0; i < before.size(); ++i) {
    if (!start[i]) continue;
    const std::optional<cv::Point2f> after = FollowThereAndBack(
        from, to, ToPoint(before[i]), ToPoint(*start[i]), options.max_round_trip, patch);
    if (after) found[i] = Eigen::Vector2d(after->x, after->y);
  }
  return found;
}

}  // namespace parkade

#include "tests/bench/suite/trajectory_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace parkade {
namespace {

constexpr int kEdge = 700;   // [px] of one panel
constexpr int kMargin = 50;  // [px]
const cv::Scalar kColors[] = {{200, 60, 0},  {0, 0, 220},   {0, 150, 0},   {200, 0, 200},
                              {0, 140, 255}, {160, 160, 0}, {90, 90, 160}, {128, 128, 128}};

struct Range {
  double low = 1e300, high = -1e300;
  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double span() const { return std::max(high - low, 1e-6); }
};

using Points = std::vector<Eigen::Vector2d>;

/// One panel with its own scales.
class Panel {
 public:
  Panel(cv::Mat image, const Range& x, const Range& y, bool is_isometric)
      : image_(image), x_(x), y_(y) {
    scale_x_ = (image.cols - 2 * kMargin) / x.span();
    scale_y_ = (image.rows - 2 * kMargin) / y.span();
    if (is_isometric) scale_x_ = scale_y_ = std::min(scale_x_, scale_y_);
    cv::rectangle(image_, {kMargin / 2, kMargin / 2},
                  {image.cols - kMargin / 2, image.rows - kMargin / 2}, {200, 200, 200});
    Label(x.low, y.low);
    Label(x.high, y.high);
  }

  void Draw(const Points& points, const cv::Scalar& color, int width) {
    std::vector<cv::Point> pixels;
    for (const Eigen::Vector2d& point : points) pixels.push_back(At(point));
    cv::polylines(image_, pixels, false, color, width, cv::LINE_AA);
  }

  void Write(const std::string& text, int line, const cv::Scalar& color) {
    cv::putText(image_, text, {kMargin, kMargin + 18 * line}, cv::FONT_HERSHEY_SIMPLEX, 0.45, color,
                1, cv::LINE_AA);
  }

 private:
  cv::Point At(const Eigen::Vector2d& point) const {
    return {kMargin + static_cast<int>(std::lround((point.x() - x_.low) * scale_x_)),
            image_.rows - kMargin - static_cast<int>(std::lround((point.y() - y_.low) * scale_y_))};
  }

  void Label(double x, double y) {
    char text[40];
    std::snprintf(text, sizeof text, "%.4g, %.3g", x, y);
    cv::putText(image_, text, At({x, y}) + cv::Point(y > y_.low ? -90 : -20, y > y_.low ? -8 : 16),
                cv::FONT_HERSHEY_SIMPLEX, 0.4, {80, 80, 80}, 1, cv::LINE_AA);
  }

  cv::Mat image_;
  Range x_, y_;
  double scale_x_ = 1, scale_y_ = 1;
};

Points FromAbove(const std::vector<TimedPose>& way) {
  Points points;
  for (const TimedPose& pose : way) points.push_back(pose.world_from_frame.translation.head<2>());
  return points;
}

struct ErrorCurves {
  Points horizontal, vertical;
};

/// Against the truth, linear between its poses.
ErrorCurves ErrorsOf(const std::vector<TimedPose>& way, const std::vector<TimedPose>& truth) {
  ErrorCurves curves;
  for (const TimedPose& pose : way) {
    const auto later =
        std::lower_bound(truth.begin(), truth.end(), pose.time,
                         [](const TimedPose& a, Timestamp time) { return a.time < time; });
    if (later == truth.end()) break;
    if (later == truth.begin()) continue;
    const TimedPose &before = *(later - 1), &after = *later;
    const double share = (pose.time - before.time) / (after.time - before.time);
    const Eigen::Vector3d there = (1 - share) * before.world_from_frame.translation +
                                  share * after.world_from_frame.translation;
    const Eigen::Vector3d off = pose.world_from_frame.translation - there;
    const double time = pose.time - truth.front().time;
    curves.horizontal.emplace_back(time, off.head<2>().norm());
    curves.vertical.emplace_back(time, off.z());
  }
  return curves;
}

}  // namespace

cv::Mat PlotTrajectories(const std::string& title, const std::vector<TimedPose>& truth,
                         const std::vector<PlottedWay>& ways) {
  cv::Mat image(kEdge, 2 * kEdge, CV_8UC3, cv::Scalar(255, 255, 255));
  Range x, y, time, horizontal, vertical;
  for (const Eigen::Vector2d& point : FromAbove(truth)) {
    x.Add(point.x());
    y.Add(point.y());
  }
  std::vector<ErrorCurves> errors;
  for (const PlottedWay& way : ways) {
    errors.push_back(ErrorsOf(way.world_from_imu, truth));
    for (const Eigen::Vector2d& point : errors.back().horizontal) {
      time.Add(point.x());
      horizontal.Add(point.y());
    }
    for (const Eigen::Vector2d& point : errors.back().vertical) vertical.Add(point.y());
  }
  Panel map(image(cv::Rect(0, 0, kEdge, kEdge)), x, y, true);
  Panel upper(image(cv::Rect(kEdge, 0, kEdge, kEdge / 2)), time, horizontal, false);
  Panel lower(image(cv::Rect(kEdge, kEdge / 2, kEdge, kEdge / 2)), time, vertical, false);
  map.Write(title, 0, {0, 0, 0});
  upper.Write("horizontal error [m] over time [s]", 0, {0, 0, 0});
  lower.Write("height error [m]", 0, {0, 0, 0});
  map.Draw(FromAbove(truth), {0, 0, 0}, 3);
  for (size_t i = 0; i < ways.size(); ++i) {
    const cv::Scalar& color = kColors[i % std::size(kColors)];
    map.Draw(FromAbove(ways[i].world_from_imu), color, 1);
    map.Write(ways[i].name, static_cast<int>(i) + 1, color);
    upper.Draw(errors[i].horizontal, color, 1);
    lower.Draw(errors[i].vertical, color, 1);
  }
  return image;
}

}  // namespace parkade

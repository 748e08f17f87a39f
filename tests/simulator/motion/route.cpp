#include "tests/simulator/motion/route.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace parkade::simulator {
namespace {

using Path = std::vector<Eigen::Vector3d>;

/// Points at equal steps in the plane along a polyline, from its start up to its end.
Path Resample(const Path& path, double step) {
  Path result = {path.front()};
  double carried = 0;  // distance since the last point put out
  for (size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector3d side = path[i] - path[i - 1];
    const double length = side.head<2>().norm();
    double along = step - carried;
    for (; along <= length; along += step) result.push_back(path[i - 1] + side * (along / length));
    carried = length - (along - step);
  }
  return result;
}

/// How much of a side an arc may take: half of it is the next arc's, unless it is the first or last
/// side.
double RoomOn(const Eigen::Vector2d& side, bool is_end) {
  constexpr double kStraightEnd = 1.6;  // [m] more than what smoothing reaches
  const double half = 0.499 * side.norm();
  return is_end ? std::max(half, side.norm() - kStraightEnd) : half;
}

/// Replaces the corner `index` by an arc; heights run straight along it.
void AppendArc(const Path& waypoints, size_t index, double max_radius, Path& path) {
  const Eigen::Vector3d &before = waypoints[index - 1], &corner = waypoints[index],
                        &after = waypoints[index + 1];
  const Eigen::Vector2d side_in = (corner - before).head<2>(),
                        side_out = (after - corner).head<2>();
  const Eigen::Vector2d in = side_in.normalized(), out = side_out.normalized();
  const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
  if (std::abs(turn) < 1e-6) return path.push_back(corner);
  const double room =
      std::min(RoomOn(side_in, index == 1), RoomOn(side_out, index + 2 == waypoints.size()));
  // A slight bend is driven as a wide arc, a corner as a tight one.
  const double wanted_radius = std::abs(turn) < 0.5 ? 6 * max_radius : max_radius;
  const double radius = std::min(wanted_radius, room / std::tan(std::abs(turn) / 2));
  const double tangent = radius * std::tan(std::abs(turn) / 2);
  const Eigen::Vector2d left(-in.y(), in.x());
  const double side = turn > 0 ? 1 : -1;
  const Eigen::Vector2d center = corner.head<2>() - tangent * in + side * radius * left;
  const double height_in = corner.z() + (before.z() - corner.z()) * tangent / side_in.norm(),
               height_out = corner.z() + (after.z() - corner.z()) * tangent / side_out.norm();
  const int num_steps = 2 + static_cast<int>(radius * std::abs(turn) / 0.02);
  for (int i = 0; i <= num_steps; ++i) {
    const double angle = turn * i / num_steps, share = static_cast<double>(i) / num_steps;
    const Eigen::Vector2d point =
        center + radius * (std::abs(std::sin(angle)) * in - side * std::cos(angle) * left);
    path.emplace_back(point.x(), point.y(), height_in + share * (height_out - height_in));
  }
}

/// Running mean over 2 * half + 1 points; the ends are continued in line.
Path Smoothed(const Path& path, int half) {
  const int size = static_cast<int>(path.size());
  const auto at = [&](int i) -> Eigen::Vector3d {
    if (i < 0) return 2 * path.front() - path[static_cast<size_t>(std::min(-i, size - 1))];
    if (i >= size)
      return 2 * path.back() - path[static_cast<size_t>(std::max(0, 2 * size - 2 - i))];
    return path[static_cast<size_t>(i)];
  };
  Path result(path.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = -half; i <= half; ++i) sum += at(i);
  for (int i = 0; i < size; ++i) {
    result[static_cast<size_t>(i)] = sum / (2 * half + 1);
    sum += at(i + half + 1) - at(i - half);
  }
  return result;
}

}  // namespace

Route::Route(const std::vector<Eigen::Vector3d>& waypoints, double radius) {
  Require(waypoints.size() >= 2, ErrorCode::kInternal, "a route needs two waypoints");
  Path path = {waypoints.front()};
  for (size_t i = 1; i + 1 < waypoints.size(); ++i) AppendArc(waypoints, i, radius, path);
  path.push_back(waypoints.back());
  path = Resample(path, step_);
  // Three running means make the curvature itself C1.
  for (const double width : {0.9, 0.7, 0.5}) path = Smoothed(path, static_cast<int>(width / step_));
  points_ = Resample(path, step_);

  double previous = 0;
  for (size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d tangent =
        points_[std::min(i + 1, points_.size() - 1)] - points_[i == 0 ? 0 : i - 1];
    const double heading = std::atan2(tangent.y(), tangent.x());
    previous += std::remainder(heading - previous, 2 * M_PI);
    headings_.push_back(previous);
  }
}

Route Route::Part(double from, double to) const {
  constexpr size_t kFewest = 4;
  const size_t size = points_.size();
  const size_t begin = std::min(static_cast<size_t>(std::max(0.0, from) / step_), size - kFewest);
  const size_t end =
      std::clamp(static_cast<size_t>(std::max(0.0, to) / step_) + 1, begin + kFewest, size);
  const auto part = [&](const auto& values) {
    return std::vector(values.begin() + static_cast<std::ptrdiff_t>(begin),
                       values.begin() + static_cast<std::ptrdiff_t>(end));
  };
  Route result = *this;
  result.points_ = part(points_);
  result.headings_ = part(headings_);
  return result;
}

double Route::Interpolate(const std::vector<double>& values, double distance) const {
  const double place = std::clamp(distance / step_, 0.0, static_cast<double>(values.size() - 1));
  const size_t index = std::min(static_cast<size_t>(place), values.size() - 2);
  const double fraction = place - static_cast<double>(index);
  return values[index] * (1 - fraction) + values[index + 1] * fraction;
}

Eigen::Vector3d Route::PointAt(double distance) const {
  const double place = std::clamp(distance / step_, 0.0, static_cast<double>(points_.size() - 1));
  const size_t index = std::min(static_cast<size_t>(place), points_.size() - 2);
  const double fraction = place - static_cast<double>(index);
  return points_[index] * (1 - fraction) + points_[index + 1] * fraction;
}

Eigen::Vector2d Route::Position(double distance) const { return PointAt(distance).head<2>(); }

double Route::HeightHint(double distance) const { return PointAt(distance).z(); }

double Route::Heading(double distance) const { return Interpolate(headings_, distance); }

double Route::Curvature(double distance) const {
  const double reach = 0.1;
  const double from = std::max(0.0, distance - reach), to = std::min(Length(), distance + reach);
  return to > from ? (Heading(to) - Heading(from)) / (to - from) : 0;
}

}  // namespace parkade::simulator

#include "mapping/baselines/segment_by_color.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/baselines/road_colors.h"

namespace parkade {
namespace {

constexpr float kTolerance = 3.5F;  // sigmas from the road's colors; more takes in obstacles, too
constexpr double kMaxMarkingWidth =
    0.3;  // [m] a brighter stripe this wide, with road on both sides, is paint
constexpr size_t kMinSeeds = 40;  // with fewer, nothing is called ground

/// Appearance of every cell, from slightly smoothed colors.
std::vector<Appearance> MeasureAppearance(const cv::Mat& colors) {
  cv::Mat smooth, lab, lightness, mean, mean_square;
  cv::medianBlur(colors, smooth, 3);
  cv::cvtColor(smooth, lab, cv::COLOR_BGR2Lab);
  cv::extractChannel(lab, lightness, 0);
  lightness.convertTo(lightness, CV_32F);
  cv::blur(lightness, mean, {3, 3});
  cv::blur(lightness.mul(lightness), mean_square, {3, 3});
  std::vector<Appearance> appearance(lab.total());
  for (size_t i = 0; i < appearance.size(); ++i) {
    const uchar* pixel = lab.ptr() + 3 * i;
    const float m = mean.ptr<float>()[i];
    const float roughness = std::sqrt(std::max(mean_square.ptr<float>()[i] - m * m, 0.0F));
    appearance[i] << pixel[0], pixel[1], pixel[2], roughness;
  }
  return appearance;
}

/// Spreads kGround to neighbors that look like road.
void GrowGround(const GroundGrid& grid, const std::vector<std::uint8_t>& is_like_road,
                std::vector<GroundLabel>& labels) {
  std::vector<int> open;
  const auto visit = [&](int index) {
    const auto i = static_cast<size_t>(index);
    if (!is_like_road[i] || labels[i] == GroundLabel::kGround) return;
    labels[i] = GroundLabel::kGround;
    open.push_back(index);
  };
  for (size_t i = 0; i < labels.size(); ++i)
    if (labels[i] == GroundLabel::kGround) open.push_back(static_cast<int>(i));
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const int range = index % grid.num_ranges;
    if (range > 0) visit(index - 1);
    if (range + 1 < grid.num_ranges) visit(index + 1);
    if (index >= grid.num_ranges) visit(index - grid.num_ranges);
    if (index + grid.num_ranges < grid.num_rays * grid.num_ranges) visit(index + grid.num_ranges);
  }
}

/// A line of cells through the grid: along a ray or across the rays.
struct Line {
  int first = 0, stride = 1, count = 0;
};

/// Runs of what may be paint on `line`, shorter than `max_width` and with ground at both ends,
/// become ground.
void FillMarkings(const GroundGrid& grid, const std::vector<std::uint8_t>& may_be_paint,
                  const Line& line, double max_width, std::vector<GroundLabel>& labels) {
  int last_ground = -1;
  for (int i = 0; i < line.count; ++i) {
    const int index = line.first + i * line.stride;
    if (labels[static_cast<size_t>(index)] == GroundLabel::kGround) {
      if (last_ground >= 0 && i - last_ground > 1) {
        const int before = line.first + last_ground * line.stride;
        const float width = (grid.cells[static_cast<size_t>(index)].point_in_ground -
                             grid.cells[static_cast<size_t>(before)].point_in_ground)
                                .norm();
        // The two ends are road already, and smoothing made the paint wider by about as much.
        const float spacing = width / static_cast<float>(i - last_ground);
        bool is_paint = static_cast<double>(width - 3 * spacing) <= max_width;
        for (int k = last_ground + 1; is_paint && k < i; ++k)
          is_paint = may_be_paint[static_cast<size_t>(line.first + k * line.stride)] != 0;
        for (int k = last_ground + 1; is_paint && k < i; ++k)
          labels[static_cast<size_t>(line.first + k * line.stride)] = GroundLabel::kGround;
      }
      last_ground = i;
    }
  }
}

}  // namespace

std::vector<GroundLabel> SegmentByColor(const GroundGrid& grid, const cv::Mat& colors,
                                        const std::vector<std::uint8_t>& seeds) {
  std::vector<GroundLabel> labels(grid.cells.size(), GroundLabel::kUnknown);
  if (grid.cells.empty()) return labels;
  const std::vector<Appearance> appearance = MeasureAppearance(colors);
  std::vector<Appearance> road;
  for (size_t i = 0; i < seeds.size(); ++i)
    if (seeds[i] && grid.cells[i].is_visible) road.push_back(appearance[i]);
  if (road.size() < kMinSeeds) return labels;

  const RoadColors road_colors(road);
  std::vector<std::uint8_t> is_like_road(grid.cells.size()), may_be_paint(grid.cells.size());
  for (size_t i = 0; i < grid.cells.size(); ++i) {
    if (!grid.cells[i].is_visible) continue;
    is_like_road[i] = road_colors.DistanceTo(appearance[i]) < kTolerance;
    labels[i] = seeds[i] && is_like_road[i] ? GroundLabel::kGround : GroundLabel::kNotGround;
    may_be_paint[i] = is_like_road[i] || road_colors.MayBePaint(appearance[i]);
  }
  GrowGround(grid, is_like_road, labels);
  for (int ray = 0; ray < grid.num_rays; ++ray)
    FillMarkings(grid, may_be_paint, {grid.IndexOf(ray, 0), 1, grid.num_ranges}, kMaxMarkingWidth,
                 labels);
  for (int range = 0; range < grid.num_ranges; ++range)
    FillMarkings(grid, may_be_paint, {range, grid.num_ranges, grid.num_rays}, kMaxMarkingWidth,
                 labels);
  // Paint is an island until it is filled: what lies behind it is reached only now.
  GrowGround(grid, is_like_road, labels);
  return labels;
}

}  // namespace parkade

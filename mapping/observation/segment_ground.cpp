#include "mapping/observation/segment_ground.h"

#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "mapping/observation/road_colors.h"

namespace parkade {
namespace {

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

/// The confidence of what lies `depth` [m] behind the foot of an obstacle, on its ray.
GroundLabel LabelBehind(double depth, const SegmentGroundOptions& options, bool is_trusted) {
  if (is_trusted && depth < options.obstacle_depth) return GroundLabel::kHidden;
  return depth < options.beyond_depth ? GroundLabel::kBeyond : GroundLabel::kUnknown;
}

}  // namespace

void SegmentGroundOptions::Validate() const {
  Require(color_tolerance > 0, ErrorCode::kUsage, "color_tolerance must be > 0");
  Require(max_marking_width >= 0, ErrorCode::kUsage, "max_marking_width must not be negative");
  Require(hidden_confidence >= 0 && hidden_confidence <= 1, ErrorCode::kUsage,
          "hidden_confidence must be in 0..1");
  Require(obstacle_depth > 0 && foot_depth > 0, ErrorCode::kUsage,
          "obstacle_depth and foot_depth must be > 0 m");
  Require(beyond_depth >= 0, ErrorCode::kUsage, "beyond_depth must not be negative");
  Require(min_seeds > 0, ErrorCode::kUsage, "min_seeds must be > 0");
  Require(sure_log_odds > 0, ErrorCode::kUsage, "sure_log_odds must be > 0");
  Require(doubt_per_meter >= 0, ErrorCode::kUsage, "doubt_per_meter must not be negative");
}

std::vector<GroundLabel> SegmentGround(const GroundGrid& grid, const cv::Mat& colors,
                                       const std::vector<std::uint8_t>& seeds,
                                       const SegmentGroundOptions& options) {
  std::vector<GroundLabel> labels(grid.cells.size(), GroundLabel::kUnknown);
  if (grid.cells.empty()) return labels;
  const std::vector<Appearance> appearance = MeasureAppearance(colors);
  std::vector<Appearance> road;
  for (size_t i = 0; i < seeds.size(); ++i)
    if (seeds[i] && grid.cells[i].is_visible) road.push_back(appearance[i]);
  if (road.size() < static_cast<size_t>(options.min_seeds)) return labels;

  const RoadColors road_colors(road);
  const auto tolerance = static_cast<float>(options.color_tolerance);
  std::vector<std::uint8_t> is_like_road(grid.cells.size()), may_be_paint(grid.cells.size());
  for (size_t i = 0; i < grid.cells.size(); ++i) {
    if (!grid.cells[i].is_visible) continue;
    is_like_road[i] = road_colors.DistanceTo(appearance[i]) < tolerance;
    labels[i] = seeds[i] && is_like_road[i] ? GroundLabel::kGround : GroundLabel::kNotGround;
    may_be_paint[i] = is_like_road[i] || road_colors.MayBePaint(appearance[i]);
  }
  GrowGround(grid, is_like_road, labels);
  for (int ray = 0; ray < grid.num_rays; ++ray)
    FillMarkings(grid, may_be_paint, {grid.IndexOf(ray, 0), 1, grid.num_ranges},
                 options.max_marking_width, labels);
  for (int range = 0; range < grid.num_ranges; ++range)
    FillMarkings(grid, may_be_paint, {range, grid.num_ranges, grid.num_rays},
                 options.max_marking_width, labels);
  // Paint is an island until it is filled: what lies behind it is reached only now.
  GrowGround(grid, is_like_road, labels);
  return labels;
}

std::vector<GroundLabel> LabelsFromMask(const GroundGrid& grid, const cv::Mat& mask) {
  std::vector<GroundLabel> labels(grid.cells.size(), GroundLabel::kUnknown);
  for (size_t i = 0; i < grid.cells.size(); ++i) {
    const GroundGridCell& cell = grid.cells[i];
    if (!cell.is_visible) continue;
    const uchar value = mask.at<uchar>(static_cast<int>(std::lround(cell.pixel.y())),
                                       static_cast<int>(std::lround(cell.pixel.x())));
    labels[i] = value >= 128 ? GroundLabel::kGround : GroundLabel::kNotGround;
  }
  return labels;
}

GroundLabels LabelsFromBelief(const GroundGrid& grid, std::span<const Eigen::Vector2f> pixels,
                              const FreespaceBelief& belief, const SegmentGroundOptions& options) {
  const auto sure = static_cast<float>(options.sure_log_odds),
             doubt = static_cast<float>(options.doubt_per_meter),
             doubt_from = static_cast<float>(options.doubt_from);
  GroundLabels result{std::vector<GroundLabel>(grid.cells.size(), GroundLabel::kUnknown),
                      std::vector<float>(grid.cells.size()), true};
  for (size_t i = 0; i < grid.cells.size(); ++i) {
    const GroundGridCell& cell = grid.cells[i];
    if (!cell.is_visible || !belief.Covers(pixels[i])) continue;
    const float range = grid.ranges[i % static_cast<size_t>(grid.num_ranges)];
    const float believed = belief.At(pixels[i]), log_odds = believed - doubt * (range - doubt_from);
    if (!(believed * log_odds > 0)) {  // neither: doubt says nothing against the ground
      result.labels[i] = GroundLabel::kDoubtful;
      continue;
    }
    result.labels[i] = log_odds > 0 ? GroundLabel::kGround : GroundLabel::kNotGround;
    result.confidence[i] = std::min(1.0F, std::abs(log_odds) / sure);
  }
  return result;
}

void HideBehindObstacles(const GroundGrid& grid, const SegmentGroundOptions& options,
                         bool is_trusted, std::vector<GroundLabel>& labels) {
  for (int ray = 0; ray < grid.num_rays; ++ray) {
    double depth = 0, max_depth = options.obstacle_depth;
    bool has_ground = false;
    for (int range = 0; range < grid.num_ranges; ++range) {
      GroundLabel& label = labels[static_cast<size_t>(grid.IndexOf(ray, range))];
      const bool is_hidden = depth >= max_depth;
      if (label == GroundLabel::kGround) {
        if (is_hidden && !is_trusted) label = GroundLabel::kUnknown;
        if (is_trusted || !is_hidden) depth = 0;
        if (is_trusted)
          max_depth = options.foot_depth +
                      static_cast<double>(grid.pixel_lengths[static_cast<size_t>(range)]);
        has_ground = true;
      } else if (label == GroundLabel::kNotGround) {
        if (is_hidden || !has_ground)
          label = has_ground ? LabelBehind(depth, options, is_trusted) : GroundLabel::kUnknown;
        if (has_ground && range > 0)
          depth += static_cast<double>(grid.ranges[static_cast<size_t>(range)] -
                                       grid.ranges[static_cast<size_t>(range - 1)]);
      }
    }
  }
}

}  // namespace parkade

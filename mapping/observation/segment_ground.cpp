#include "mapping/observation/segment_ground.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/mat.hpp>

#include "core/error.h"

namespace parkade {
namespace {

/// What a sample is called that lies `depth` [m] behind the foot of an obstacle, on its ray.
GroundLabel LabelBehind(double depth, const SegmentGroundOptions& options, bool is_trusted) {
  if (is_trusted && depth < options.obstacle_depth) return GroundLabel::kHidden;
  return depth < options.beyond_depth ? GroundLabel::kBeyond : GroundLabel::kUnknown;
}

}  // namespace

void SegmentGroundOptions::Validate() const {
  Require(hidden_confidence >= 0 && hidden_confidence <= 1, ErrorCode::kUsage,
          "hidden_confidence must be in 0..1");
  Require(obstacle_depth > 0 && foot_depth > 0, ErrorCode::kUsage,
          "obstacle_depth and foot_depth must be > 0 m");
  Require(beyond_depth >= 0, ErrorCode::kUsage, "beyond_depth must not be negative");
  Require(sure_log_odds > 0, ErrorCode::kUsage, "sure_log_odds must be > 0");
  Require(doubt_per_meter >= 0, ErrorCode::kUsage, "doubt_per_meter must not be negative");
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
                      std::vector<float>(grid.cells.size())};
  result.is_trusted = true;
  if (!belief.classes.empty()) result.surfaces.resize(grid.cells.size(), SurfaceClass::kUnknown);
  for (size_t i = 0; i < grid.cells.size(); ++i) {
    const GroundGridCell& cell = grid.cells[i];
    if (!cell.is_visible || !belief.Covers(pixels[i])) continue;
    const float range = grid.ranges[i % static_cast<size_t>(grid.num_ranges)];
    if (!result.surfaces.empty()) result.surfaces[i] = belief.ClassAt(pixels[i]);
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
                         GroundLabels& found) {
  const bool is_trusted = found.is_trusted;
  for (int ray = 0; ray < grid.num_rays; ++ray) {
    double depth = 0, max_depth = options.obstacle_depth;
    bool has_ground = false;
    for (int range = 0; range < grid.num_ranges; ++range) {
      const auto at = static_cast<size_t>(grid.IndexOf(ray, range));
      GroundLabel& label = found.labels[at];
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

#include "export/gltf/tile_levels.h"

#include <climits>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "export/gltf/merge_vertices.h"
#include "export/gltf/vertex_copier.h"

namespace parkade {
namespace {

/// What one square of one layer of the finest level holds.
struct Part {
  int column = 0, row = 0, layer = 0;
  std::vector<std::uint32_t> triangles;
};

std::vector<Part> PartsOfCharts(const GroundTexture& texture) {
  std::vector<Part> parts;
  for (const TextureChart& chart : texture.charts)
    parts.push_back({chart.column, chart.row, chart.layer, chart.triangles});
  return parts;
}

std::vector<Part> PartsOfSquares(const TriangleMesh& mesh, double square_size) {
  std::map<std::pair<int, int>, Part> parts;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    Eigen::Vector3d center = mesh.origin;
    for (const std::uint32_t index : mesh.triangles[i])
      center += mesh.vertices[index].cast<double>() / 3;
    const std::pair<int, int> square(static_cast<int>(std::floor(center.y() / square_size)),
                                     static_cast<int>(std::floor(center.x() / square_size)));
    Part& part = parts[square];
    part.row = square.first;
    part.column = square.second;
    part.triangles.push_back(i);
  }
  std::vector<Part> sorted;
  for (auto& [square, part] : parts) sorted.push_back(std::move(part));
  return sorted;
}

std::string NameOf(const Part& part) {
  std::string name = "at_" + std::to_string(part.column) + "_" + std::to_string(part.row);
  if (part.layer > 0) name += "_" + std::to_string(part.layer);
  return name;
}

/// Puts charts of one level side by side into one of twice their texels.
TextureChart HalveAndJoin(const std::vector<TextureChart>& charts, double texel_size) {
  double left = charts[0].left, top = charts[0].top, right = left, bottom = top;
  for (const TextureChart& chart : charts) {
    left = std::min(left, chart.left);
    top = std::max(top, chart.top);
    right = std::max(right, chart.left + chart.image.cols * texel_size);
    bottom = std::min(bottom, chart.top - chart.image.rows * texel_size);
  }
  const double coarse = 2 * texel_size;
  const cv::Size size(std::max(1, static_cast<int>(std::ceil((right - left) / coarse))),
                      std::max(1, static_cast<int>(std::ceil((top - bottom) / coarse))));
  TextureChart joined;
  joined.left = left;
  joined.top = top;
  joined.image = cv::Mat(size, CV_8UC3, cv::Scalar::all(0));
  joined.mask = cv::Mat(size, CV_8UC1, cv::Scalar(0));
  // First what lies beyond the mesh, then, over it, the mesh itself.
  for (const bool is_mesh : {false, true})
    for (const TextureChart& chart : charts) {
      const int column = static_cast<int>(std::lround((chart.left - left) / coarse));
      const int row = static_cast<int>(std::lround((top - chart.top) / coarse));
      const cv::Size half(std::min((chart.image.cols + 1) / 2, size.width - column),
                          std::min((chart.image.rows + 1) / 2, size.height - row));
      if (half.width <= 0 || half.height <= 0) continue;
      cv::Mat image, mask;
      cv::resize(chart.image, image, half, 0, 0, cv::INTER_AREA);
      cv::resize(chart.mask != 0, mask, half, 0, 0, cv::INTER_AREA);
      mask = mask >= 128;
      const cv::Rect place({column, row}, half);
      image.copyTo(joined.image(place), is_mesh ? mask : cv::Mat());
      if (is_mesh) mask.copyTo(joined.mask(place), mask);
    }
  return joined;
}

/// Makes all levels of one map, from the finest up.
class TilePyramid {
 public:
  TilePyramid(const TriangleMesh& mesh, const GroundTexture& texture, double square_size,
              double coarse_cell, const std::function<void(const MapTile&)>& visit)
      : mesh_(mesh),
        texture_(texture),
        square_size_(texture.empty() ? square_size : texture.chart_size),
        coarse_cell_(coarse_cell),
        visit_(visit) {
    parts_ = texture.empty() ? PartsOfSquares(mesh, square_size_) : PartsOfCharts(texture);
  }

  void Visit() {
    if (parts_.empty()) return;
    Eigen::Vector2i last(INT_MIN, INT_MIN);
    for (const Part& part : parts_) {
      corner_ = corner_.cwiseMin(Eigen::Vector2i(part.column, part.row));
      last = last.cwiseMax(Eigen::Vector2i(part.column, part.row));
    }
    const int num_squares = (last - corner_).maxCoeff() + 1;
    coarsest_ = 1;
    while (1 << coarsest_ < num_squares) ++coarsest_;
    parts_at_.resize(static_cast<size_t>(coarsest_) + 1);
    representatives_.resize(parts_at_.size());
    for (int level = 0; level <= coarsest_; ++level) {
      const auto l = static_cast<size_t>(level);
      for (size_t i = 0; i < parts_.size(); ++i)
        parts_at_[l][{(parts_[i].row - corner_.y()) >> level,
                      (parts_[i].column - corner_.x()) >> level}]
            .push_back(i);
      if (level > 0) representatives_[l] = MergeVertices(mesh_, ErrorOf(level));
    }
    VisitSquare(coarsest_, 0, 0);
  }

 private:
  using Charts = std::vector<TextureChart>;

  double ErrorOf(int level) const { return level == 0 ? 0 : std::ldexp(coarse_cell_, level - 1); }

  /// Visits the square's tiles and all below them. Returns their charts.
  Charts VisitSquare(int level, int row, int column) {
    const auto found = parts_at_[static_cast<size_t>(level)].find({row, column});
    if (found == parts_at_[static_cast<size_t>(level)].end()) return {};
    if (level == 0) return VisitFinest(found->second);
    std::map<int, Charts> finer;  // by layer
    for (const int finer_row : {2 * row, 2 * row + 1})
      for (const int finer_column : {2 * column, 2 * column + 1})
        for (TextureChart& chart : VisitSquare(level - 1, finer_row, finer_column))
          finer[chart.layer].push_back(std::move(chart));
    MapTile tile{
        .level = level,
        .is_coarsest = level == coarsest_,
        .error = ErrorOf(level),
        .column = column,
        .row = row,
        .name = "level" + std::to_string(level) + "_" + std::to_string(column) + "_" +
                std::to_string(row),
        .mesh = {},
        .texture = {std::ldexp(texture_.texel_size, level), std::ldexp(square_size_, level), {}}};
    Assemble(found->second, finer, tile);
    visit_(tile);
    return std::move(tile.texture.charts);
  }

  Charts VisitFinest(const std::vector<size_t>& indices) {
    Charts charts;
    for (const size_t i : indices) {
      const Part& part = parts_[i];
      VertexCopier copier(mesh_, {part.column * square_size_, part.row * square_size_,
                                  std::round(mesh_.origin.z())});
      for (const std::uint32_t triangle : part.triangles)
        copier.AddTriangle(mesh_.triangles[triangle]);
      MapTile tile{.column = part.column - corner_.x(),
                   .row = part.row - corner_.y(),
                   .layer = part.layer,
                   .name = NameOf(part),
                   .mesh = copier.Take(),
                   .texture = {texture_.texel_size, square_size_, {}}};
      if (!texture_.empty()) {
        TextureChart& chart = tile.texture.charts.emplace_back(texture_.charts[i]);
        std::iota(chart.triangles.begin(), chart.triangles.end(), 0);
        charts.push_back(chart);
      }
      visit_(tile);
    }
    return charts;
  }

  /// What a coarse tile shows: the triangles of each layer that merging leaves, painted by what the
  /// finer level shows.
  void Assemble(const std::vector<size_t>& indices, const std::map<int, Charts>& finer,
                MapTile& tile) const {
    std::map<int, std::vector<std::uint32_t>> triangles_of_layer;
    for (const size_t i : indices) {
      std::vector<std::uint32_t>& triangles = triangles_of_layer[parts_[i].layer];
      triangles.insert(triangles.end(), parts_[i].triangles.begin(), parts_[i].triangles.end());
    }
    const double size = tile.texture.chart_size;
    const std::vector<std::uint32_t>& representative =
        representatives_[static_cast<size_t>(tile.level)];
    VertexCopier copier(
        mesh_, {corner_.x() * square_size_ + tile.column * size,
                corner_.y() * square_size_ + tile.row * size, std::round(mesh_.origin.z())});
    for (const auto& [layer, triangles] : triangles_of_layer) {
      const auto first = static_cast<std::uint32_t>(copier.mesh().triangles.size());
      for (const std::uint32_t index : triangles) {
        const auto& [a, b, c] = mesh_.triangles[index];
        const std::array<std::uint32_t, 3> merged = {representative[a], representative[b],
                                                     representative[c]};
        if (merged[0] != merged[1] && merged[1] != merged[2] && merged[2] != merged[0])
          copier.AddTriangle(merged);
      }
      const auto count = static_cast<std::uint32_t>(copier.mesh().triangles.size()) - first;
      const auto charts = finer.find(layer);
      if (count == 0 || charts == finer.end()) continue;
      TextureChart chart = HalveAndJoin(charts->second, 0.5 * tile.texture.texel_size);
      chart.layer = layer;
      chart.triangles.resize(count);
      std::iota(chart.triangles.begin(), chart.triangles.end(), first);
      tile.texture.charts.push_back(std::move(chart));
    }
    tile.mesh = copier.Take();
    texture_.Release();
  }

  const TriangleMesh& mesh_;
  const GroundTexture& texture_;
  double square_size_, coarse_cell_;
  const std::function<void(const MapTile&)>& visit_;
  std::vector<Part> parts_;
  Eigen::Vector2i corner_{INT_MAX, INT_MAX};
  int coarsest_ = 0;
  std::vector<std::map<std::pair<int, int>, std::vector<size_t>>>
      parts_at_;                                             // by level, then row and column
  std::vector<std::vector<std::uint32_t>> representatives_;  // by level
};

}  // namespace

void VisitTiles(const TriangleMesh& mesh, const GroundTexture& texture, double square_size,
                double coarse_cell, const std::function<void(const MapTile&)>& visit) {
  TilePyramid(mesh, texture, square_size, coarse_cell, visit).Visit();
}

}  // namespace parkade

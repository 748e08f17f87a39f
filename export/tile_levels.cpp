#include "export/tile_levels.h"

#include <climits>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "export/merge_vertices.h"
#include "export/vertex_copier.h"

namespace parkade {
namespace {

/// What one square of one sheet of the finest level holds.
struct Part {
  int column = 0, row = 0, sheet = 0;
  std::vector<std::uint32_t> triangles;
};

std::vector<Part> PartsOfCharts(const GroundTexture& texture) {
  std::vector<Part> parts;
  for (const TextureChart& chart : texture.charts)
    parts.push_back({chart.column, chart.row, chart.sheet, chart.triangles});
  return parts;
}

std::vector<Part> PartsOfSquares(const TriangleMesh& mesh, double square_size) {
  std::map<std::pair<int, int>, Part> parts;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    Eigen::Vector3d centre = mesh.origin;
    for (const std::uint32_t index : mesh.triangles[i]) centre += mesh.vertices[index].cast<double>() / 3;
    const std::pair<int, int> square(static_cast<int>(std::floor(centre.y() / square_size)),
                                     static_cast<int>(std::floor(centre.x() / square_size)));
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
  if (part.sheet > 0) name += "_" + std::to_string(part.sheet);
  return name;
}

/// Puts charts of one level side by side into one of twice their texels.
TextureChart HalveAndJoin(const std::vector<const TextureChart*>& charts, double texel_size) {
  double left = charts[0]->left, top = charts[0]->top, right = left, bottom = top;
  for (const TextureChart* chart : charts) {
    left = std::min(left, chart->left);
    top = std::max(top, chart->top);
    right = std::max(right, chart->left + chart->image.cols * texel_size);
    bottom = std::min(bottom, chart->top - chart->image.rows * texel_size);
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
    for (const TextureChart* chart : charts) {
      const int column = static_cast<int>(std::lround((chart->left - left) / coarse));
      const int row = static_cast<int>(std::lround((top - chart->top) / coarse));
      const cv::Size half(std::min((chart->image.cols + 1) / 2, size.width - column),
                          std::min((chart->image.rows + 1) / 2, size.height - row));
      if (half.width <= 0 || half.height <= 0) continue;
      cv::Mat image, mask;
      cv::resize(chart->image, image, half, 0, 0, cv::INTER_AREA);
      cv::resize(chart->mask, mask, half, 0, 0, cv::INTER_AREA);
      mask = mask >= 128;
      const cv::Rect place({column, row}, half);
      image.copyTo(joined.image(place), is_mesh ? mask : cv::Mat());
      if (is_mesh) mask.copyTo(joined.mask(place), mask);
    }
  return joined;
}

/// One tile of a coarse level and what it is made of.
struct Assembly {
  std::map<int, std::vector<std::uint32_t>> triangles_of_sheet;
  std::map<int, std::vector<const TextureChart*>> finer_charts;  ///< by sheet
};

/// What a coarse tile shows: the triangles of each sheet that merging leaves, painted by what the finer level shows.
void Assemble(const TriangleMesh& mesh, const std::vector<std::uint32_t>& representative, const Assembly& assembly,
              double texel_size, MapTile& tile) {
  VertexCopier copier(mesh, tile.mesh.origin);
  for (const auto& [sheet, triangles] : assembly.triangles_of_sheet) {
    const auto first = static_cast<std::uint32_t>(copier.mesh().triangles.size());
    for (const std::uint32_t index : triangles) {
      const auto& [a, b, c] = mesh.triangles[index];
      const std::array<std::uint32_t, 3> merged = {representative[a], representative[b], representative[c]};
      if (merged[0] != merged[1] && merged[1] != merged[2] && merged[2] != merged[0]) copier.AddTriangle(merged);
    }
    const auto count = static_cast<std::uint32_t>(copier.mesh().triangles.size()) - first;
    const auto charts = assembly.finer_charts.find(sheet);
    if (count == 0 || charts == assembly.finer_charts.end()) continue;
    TextureChart chart = HalveAndJoin(charts->second, 0.5 * texel_size);
    chart.sheet = sheet;
    chart.triangles.resize(count);
    std::iota(chart.triangles.begin(), chart.triangles.end(), first);
    tile.texture.charts.push_back(std::move(chart));
  }
  tile.mesh = copier.Take();
}

/// The level above `finer`. `parts` are those of the finest level, `shift` how many levels up this one is.
MapLevel MakeCoarser(const TriangleMesh& mesh, const std::vector<Part>& parts, const Eigen::Vector2i& corner, int shift,
                     const MapLevel& finer, double cell, double square_size) {
  std::map<std::pair<int, int>, Assembly> assemblies;
  for (const Part& part : parts) {
    const std::pair square((part.row - corner.y()) >> shift, (part.column - corner.x()) >> shift);
    std::vector<std::uint32_t>& triangles = assemblies[square].triangles_of_sheet[part.sheet];
    triangles.insert(triangles.end(), part.triangles.begin(), part.triangles.end());
  }
  for (const MapTile& tile : finer.tiles)
    for (const TextureChart& chart : tile.texture.charts)
      assemblies[{tile.row >> 1, tile.column >> 1}].finer_charts[chart.sheet].push_back(&chart);

  const std::vector<std::uint32_t> representative = MergeVertices(mesh, cell);
  const double size = std::ldexp(square_size, shift), texel_size = 2 * finer.tiles.front().texture.texel_size;
  MapLevel level{.error = cell, .tiles = {}};
  for (const auto& [square, assembly] : assemblies) {
    const auto& [row, column] = square;
    MapTile& tile = level.tiles.emplace_back();
    tile.column = column;
    tile.row = row;
    tile.name = "level" + std::to_string(shift) + "_" + std::to_string(column) + "_" + std::to_string(row);
    tile.mesh.origin = {corner.x() * square_size + column * size, corner.y() * square_size + row * size,
                        std::round(mesh.origin.z())};
    tile.texture = {texel_size, size, {}};
    Assemble(mesh, representative, assembly, texel_size, tile);
  }
  return level;
}

MapLevel MakeFinest(const TriangleMesh& mesh, const std::vector<Part>& parts, const Eigen::Vector2i& corner,
                    const GroundTexture& texture, double square_size) {
  MapLevel level;
  for (size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    VertexCopier copier(mesh, {part.column * square_size, part.row * square_size, std::round(mesh.origin.z())});
    for (const std::uint32_t triangle : part.triangles) copier.AddTriangle(mesh.triangles[triangle]);
    MapTile tile{.column = part.column - corner.x(),
                 .row = part.row - corner.y(),
                 .sheet = part.sheet,
                 .name = NameOf(part),
                 .mesh = copier.Take(),
                 .texture = {texture.texel_size, square_size, {}}};
    if (!texture.empty()) {
      tile.texture.charts.push_back(texture.charts[i]);
      std::iota(tile.texture.charts[0].triangles.begin(), tile.texture.charts[0].triangles.end(), 0);
    }
    level.tiles.push_back(std::move(tile));
  }
  return level;
}

}  // namespace

std::vector<MapLevel> CutIntoLevels(const TriangleMesh& mesh, const GroundTexture& texture, double square_size,
                                    double coarse_cell) {
  if (!texture.empty()) square_size = texture.chart_size;
  const std::vector<Part> parts = texture.empty() ? PartsOfSquares(mesh, square_size) : PartsOfCharts(texture);
  std::vector<MapLevel> levels;
  if (parts.empty()) return levels;
  Eigen::Vector2i corner(INT_MAX, INT_MAX), last(INT_MIN, INT_MIN);
  for (const Part& part : parts) {
    corner = corner.cwiseMin(Eigen::Vector2i(part.column, part.row));
    last = last.cwiseMax(Eigen::Vector2i(part.column, part.row));
  }
  levels.push_back(MakeFinest(mesh, parts, corner, texture, square_size));
  const int num_squares = (last - corner).maxCoeff() + 1;
  for (int shift = 1; shift == 1 || 1 << (shift - 1) < num_squares; ++shift)
    levels.push_back(
        MakeCoarser(mesh, parts, corner, shift, levels.back(), std::ldexp(coarse_cell, shift - 1), square_size));
  return levels;
}

}  // namespace parkade

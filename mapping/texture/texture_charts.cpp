#include "mapping/texture/texture_charts.h"

#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

namespace parkade {
namespace {

using Triangles = std::vector<std::uint32_t>;

constexpr double kFoldHeight = 0.5;  // [m] two heights at one texel that differ more are two decks
constexpr double kBandHeight = 1.5;  // [m] no ramp climbs as much within its own width

Eigen::Vector3d VertexOf(const TriangleMesh& mesh, std::uint32_t index) {
  return mesh.origin + mesh.vertices[index].cast<double>();
}

Eigen::Vector3d CenterOf(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (VertexOf(mesh, a) + VertexOf(mesh, b) + VertexOf(mesh, c)) / 3;
}

/// An empty image that holds the triangles, its edges on whole texels.
BlankChart MakeChart(const TriangleMesh& mesh, Triangles triangles, double texel_size) {
  Eigen::Vector2d low = CenterOf(mesh, triangles[0]).head<2>(), high = low;
  for (const std::uint32_t triangle : triangles)
    for (const std::uint32_t vertex : mesh.triangles[triangle]) {
      low = low.cwiseMin(VertexOf(mesh, vertex).head<2>());
      high = high.cwiseMax(VertexOf(mesh, vertex).head<2>());
    }
  const Eigen::Array2i first = (low / texel_size).array().floor().cast<int>() - 1;
  const Eigen::Array2i last = (high / texel_size).array().ceil().cast<int>() + 1;
  BlankChart blank;
  blank.chart.left = first.x() * texel_size;
  blank.chart.top = last.y() * texel_size;
  const cv::Size size(last.x() - first.x(), last.y() - first.y());
  blank.chart.image = cv::Mat(size, CV_8UC3, cv::Scalar::all(0));
  blank.chart.mask = cv::Mat(size, CV_8UC1, cv::Scalar(0));
  blank.height = cv::Mat(size, CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  blank.chart.triangles = std::move(triangles);
  return blank;
}

/// Heights of one triangle at the centers of the texels inside. False where another layer is there
/// already.
bool DrawTriangle(const std::array<Eigen::Vector3d, 3>& corners, double texel_size,
                  BlankChart& blank) {
  const auto& [a, b, c] = corners;
  const double area =
      (b - a).head<2>().x() * (c - a).head<2>().y() - (b - a).head<2>().y() * (c - a).head<2>().x();
  if (std::abs(area) < 1e-12) return true;
  const auto column_of = [&](double x) { return (x - blank.chart.left) / texel_size - 0.5; };
  const auto row_of = [&](double y) { return (blank.chart.top - y) / texel_size - 0.5; };
  const auto [min_x, max_x] = std::minmax({a.x(), b.x(), c.x()});
  const auto [min_y, max_y] = std::minmax({a.y(), b.y(), c.y()});
  // An edge through centers of texels may be rounded to either side, in each chart anew.
  constexpr double kRounding = 1e-6;
  bool is_single = true;
  for (int row = static_cast<int>(std::ceil(row_of(max_y) - kRounding));
       row <= static_cast<int>(std::floor(row_of(min_y) + kRounding)); ++row)
    for (int column = static_cast<int>(std::ceil(column_of(min_x) - kRounding));
         column <= static_cast<int>(std::floor(column_of(max_x) + kRounding)); ++column) {
      const Eigen::Vector2d p(blank.chart.left + (column + 0.5) * texel_size,
                              blank.chart.top - (row + 0.5) * texel_size);
      const auto cross = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
        return ((to - from).x() * (p.y() - from.y()) - (to - from).y() * (p.x() - from.x())) / area;
      };
      const double of_c = cross(a, b), of_a = cross(b, c), of_b = cross(c, a);
      constexpr double kOnEdge = -kRounding;
      if (of_a < kOnEdge || of_b < kOnEdge || of_c < kOnEdge) continue;
      const auto height = static_cast<float>(of_a * a.z() + of_b * b.z() + of_c * c.z());
      float& texel = blank.height.at<float>(row, column);
      if (!std::isnan(texel) && std::abs(static_cast<double>(texel - height)) > kFoldHeight)
        is_single = false;
      if (std::isnan(texel) || height > texel) texel = height;
      blank.chart.mask.at<std::uint8_t>(row, column) = TextureChart::kPlain;
    }
  return is_single;
}

/// False where the triangles lie above each other.
bool DrawHeights(const TriangleMesh& mesh, double texel_size, BlankChart& blank) {
  bool is_single = true;
  for (const std::uint32_t triangle : blank.chart.triangles) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    is_single &=
        DrawTriangle({VertexOf(mesh, a), VertexOf(mesh, b), VertexOf(mesh, c)}, texel_size, blank);
  }
  return is_single;
}

/// Pieces that share no vertex, in order of their first triangle.
std::vector<Triangles> SplitIntoPieces(const TriangleMesh& mesh, const Triangles& triangles) {
  std::vector<std::size_t> root(triangles.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::unordered_map<std::uint32_t, std::size_t> first_at_vertex;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t vertex : mesh.triangles[triangles[i]]) {
      const std::size_t one = find(first_at_vertex.try_emplace(vertex, i).first->second),
                        other = find(i);
      root[std::max(one, other)] = std::min(one, other);
    }
  std::map<std::size_t, Triangles> pieces;
  for (std::size_t i = 0; i < triangles.size(); ++i) pieces[find(i)].push_back(triangles[i]);
  std::vector<Triangles> result;
  result.reserve(pieces.size());
  for (auto& [first, piece] : pieces) result.push_back(std::move(piece));
  return result;
}

std::vector<Triangles> SplitIntoBands(const TriangleMesh& mesh, const Triangles& triangles) {
  std::map<int, Triangles> bands;
  for (const std::uint32_t triangle : triangles)
    bands[static_cast<int>(std::floor(CenterOf(mesh, triangle).z() / kBandHeight))].push_back(
        triangle);
  std::vector<Triangles> result;
  result.reserve(bands.size());
  for (auto& [height, band] : bands) result.push_back(std::move(band));
  return result;
}

std::vector<BlankChart> ChartsOfSquare(const TriangleMesh& mesh, const Triangles& triangles,
                                       double texel_size) {
  std::vector<BlankChart> charts;
  charts.push_back(MakeChart(mesh, triangles, texel_size));
  if (DrawHeights(mesh, texel_size, charts.back())) return charts;
  charts.clear();
  for (const Triangles& piece : SplitIntoPieces(mesh, triangles)) {
    charts.push_back(MakeChart(mesh, piece, texel_size));
    if (DrawHeights(mesh, texel_size, charts.back())) continue;
    charts.pop_back();
    for (Triangles& band : SplitIntoBands(mesh, piece)) {
      charts.push_back(MakeChart(mesh, std::move(band), texel_size));
      DrawHeights(mesh, texel_size, charts.back());
    }
  }
  return charts;
}

}  // namespace

std::vector<ChartSquare> CutIntoSquares(const TriangleMesh& mesh, double chart_size) {
  std::map<std::pair<int, int>, Triangles> squares;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3d center = CenterOf(mesh, i);
    squares[{static_cast<int>(std::floor(center.y() / chart_size)),
             static_cast<int>(std::floor(center.x() / chart_size))}]
        .push_back(i);
  }
  std::vector<ChartSquare> list;
  list.reserve(squares.size());
  for (auto& [at, triangles] : squares) list.push_back({at.second, at.first, std::move(triangles)});
  return list;
}

std::vector<BlankChart> ChartsOf(const ChartSquare& square, const TriangleMesh& mesh,
                                 double texel_size) {
  std::vector<BlankChart> charts = ChartsOfSquare(mesh, square.triangles, texel_size);
  for (std::size_t layer = 0; layer < charts.size(); ++layer) {
    charts[layer].chart.row = square.row;
    charts[layer].chart.column = square.column;
    charts[layer].chart.layer = static_cast<int>(layer);
  }
  return charts;
}

}  // namespace parkade

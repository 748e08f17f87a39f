#include "mapping/kerbs/outline_strips.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "core/math/decompositions.h"
#include "core/parallel.h"
#include "mapping/ground/cell_finder.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep = 0.1;            // [m] between points of an outline
constexpr double kMaxRaggedness = 0.06;  // [m] rms of a piece of outline about a straight line
constexpr double kInside = 0.7;   // [m] of ground beside the outline that its height is taken from
constexpr double kRim = 0.1;      // [m] of it that may be of something else
constexpr double kMaxStep = 0.3;  // [m] between that ground and the outline
constexpr float kFreeBelief = 0.5F;
constexpr double kMaxUnevenness = 0.02;  // [m] rms of that ground about a plane
constexpr int kMinCells = 12;

/// The closed outlines of a mesh, the ground on the left. Every vertex of an outline has one edge
/// that goes on.
std::vector<std::vector<Vector3d>> RingsOf(const TriangleMesh& mesh) {
  const auto key = [](std::uint32_t from, std::uint32_t to) {
    return (std::uint64_t{from} << 32U) | to;
  };
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(key(triangle[i], triangle[(i + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  std::unordered_map<std::uint32_t, std::uint32_t> next;
  std::vector<std::uint32_t> starts;  // in the order of the triangles
  for (const auto& triangle : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangle[i], to = triangle[(i + 1) % 3];
      if (std::binary_search(edges.begin(), edges.end(), key(to, from))) continue;
      if (next.emplace(from, to).second) starts.push_back(from);
    }
  std::vector<std::vector<Vector3d>> rings;
  for (const std::uint32_t start : starts) {
    std::vector<Vector3d> ring;
    for (auto at = next.find(start); at != next.end();) {
      ring.push_back(mesh.origin + mesh.vertices[at->first].cast<double>());
      const std::uint32_t following = at->second;
      next.erase(at);
      at = next.find(following);
    }
    if (ring.size() > 2) rings.push_back(std::move(ring));
  }
  return rings;
}

/// A ring in equal steps of about kStep.
std::vector<Vector3d> Resampled(const std::vector<Vector3d>& ring) {
  double length = 0;
  for (std::size_t i = 0; i < ring.size(); ++i)
    length += (ring[(i + 1) % ring.size()] - ring[i]).norm();
  const int count = std::max(1, static_cast<int>(length / kStep));
  std::vector<Vector3d> points;
  double passed = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector3d &from = ring[i], &to = ring[(i + 1) % ring.size()];
    const double edge = (to - from).norm();
    for (double at = static_cast<double>(points.size()) * length / count;
         at < passed + edge && edge > 0; at = static_cast<double>(points.size()) * length / count)
      points.push_back(from + (at - passed) / edge * (to - from));
    passed += edge;
  }
  return points;
}

/// The straight line through some points, along their order; nothing where they are not straight.
struct Line {
  Vector2d middle, along;
  double height = 0;
};

std::optional<Line> FitLine(const std::vector<Vector3d>& ring, int center, int half) {
  const int size = static_cast<int>(ring.size());
  if (size < 2 * half + 1) return {};
  const auto at = [&](int i) { return ring[static_cast<std::size_t>((i % size + size) % size)]; };
  Vector3d mean = Vector3d::Zero();
  for (int i = center - half; i <= center + half; ++i) mean += at(i) / (2 * half + 1);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (int i = center - half; i <= center + half; ++i) {
    const Vector2d offset = (at(i) - mean).head<2>();
    spread += offset * offset.transpose() / (2 * half + 1);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  if (std::sqrt(std::max(0.0, solver.eigenvalues()[0])) > kMaxRaggedness) return {};
  Vector2d along = solver.eigenvectors().col(1);
  if (along.dot((at(center + half) - at(center - half)).head<2>()) < 0) along = -along;
  return Line{mean.head<2>(), along, mean.z()};
}

/// Puts the strip on the plane of the ground beside it; false where there is none.
bool LayDown(const CellFinder& cells, double length, OutlineStrip& strip) {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Vector3d products = Vector3d::Zero();
  double heights = 0, sigmas = 0;
  int count = 0;
  const int num_along = 1 + static_cast<int>(std::lround(length / kStep)),
            num_across = 1 + static_cast<int>(std::lround((kInside - kRim) / kStep));
  for (int i = 0; i < num_along; ++i)
    for (int k = 0; k < num_across; ++k) {
      const double s = i * kStep - 0.5 * length, u = kRim + k * kStep;
      const Vector2d place = strip.foot.head<2>() + s * strip.along - u * strip.Outward();
      const SurfaceCell* cell = cells.Find({place.x(), place.y(), strip.foot.z()});
      if (cell == nullptr || cell->free_belief < kFreeBelief) continue;
      const double height = static_cast<double>(cell->height) - strip.foot.z();
      if (std::abs(height) > kMaxStep) continue;
      const Vector3d row(1, s, u);
      squares += row * row.transpose();
      products += row * height;
      heights += height * height;
      sigmas += static_cast<double>(cell->height_sigma);
      ++count;
    }
  if (count < kMinCells) return false;
  const Vector3d plane = SolveSymmetric(squares, products);
  if (!plane.allFinite() ||
      std::sqrt(std::max(0.0, heights - plane.dot(products)) / count) > kMaxUnevenness)
    return false;
  strip.foot.z() += plane[0];
  strip.slope = plane[1];
  strip.slope_outward = -plane[2];
  strip.height_sigma = sigmas / count;
  return true;
}

}  // namespace

std::vector<OutlineStrip> CutOutline(const TriangleMesh& mesh, const SurfaceMap& surface,
                                     double length) {
  const CellFinder cells(surface);
  const std::vector<std::vector<Vector3d>> rings = RingsOf(mesh);
  const auto of_rings = ParallelMap(rings.size(), [&](std::size_t r) {
    const std::vector<Vector3d> ring = Resampled(rings[r]);
    const double per_strip = length / kStep;
    const int count = std::max(1, static_cast<int>(static_cast<double>(ring.size()) / per_strip));
    std::vector<OutlineStrip> strips;
    for (int i = 0; i < count; ++i) {
      const int center = static_cast<int>((i + 0.5) * static_cast<double>(ring.size()) / count);
      // Half a strip more to each side tells its direction better.
      const std::optional<Line> line = FitLine(ring, center, static_cast<int>(per_strip));
      if (!line) continue;
      OutlineStrip strip{static_cast<int>(r),
                         i,
                         count,
                         {line->middle.x(), line->middle.y(), line->height},
                         line->along};
      if (LayDown(cells, length, strip)) strips.push_back(strip);
    }
    return strips;
  });
  std::vector<OutlineStrip> all;
  for (const std::vector<OutlineStrip>& strips : of_rings)
    all.insert(all.end(), strips.begin(), strips.end());
  return all;
}

}  // namespace parkade

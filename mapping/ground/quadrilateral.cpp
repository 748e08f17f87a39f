#include "mapping/ground/quadrilateral.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

template <typename Points>
double AreaOf(const Points& points) {
  double twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    twice += Cross(points[i], points[(i + 1) % points.size()]);
  return 0.5 * twice;
}

}  // namespace

double SignedArea(const Quadrilateral& shape) { return AreaOf(shape); }

double SharedArea(const Quadrilateral& a, const Quadrilateral& b) {
  std::vector<Vector2d> rest(a.begin(), a.end());
  for (std::size_t i = 0; i < b.size() && !rest.empty(); ++i) {
    const Vector2d &from = b[i], side = b[(i + 1) % b.size()] - from;
    std::vector<Vector2d> inside;
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const Vector2d &here = rest[k], &next = rest[(k + 1) % rest.size()];
      const double here_left = Cross(side, here - from), next_left = Cross(side, next - from);
      if (here_left >= 0) inside.push_back(here);
      if ((here_left < 0) != (next_left < 0))
        inside.push_back(here + here_left / (here_left - next_left) * (next - here));
    }
    rest = std::move(inside);
  }
  return rest.size() < 3 ? 0 : AreaOf(rest);
}

double OverlapOf(const Quadrilateral& a, const Quadrilateral& b) {
  const double shared = SharedArea(a, b);
  return shared / (SignedArea(a) + SignedArea(b) - shared);
}

bool Contains(const Quadrilateral& shape, const Vector2d& point, double margin) {
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Vector2d side = shape[(i + 1) % shape.size()] - shape[i];
    if (Cross(side, point - shape[i]) < margin * side.norm()) return false;
  }
  return true;
}

}  // namespace parkade

#include "tests/simulator/ground/ground.h"

#include <cmath>
#include <limits>

#include "core/error.h"

namespace parkade::simulator {

Ground::Ground(std::vector<GroundSheet> sheets) : sheets_(std::move(sheets)) {
  Require(!sheets_.empty(), ErrorCode::kInternal, "a ground needs a sheet");
}

size_t Ground::SheetAt(const Eigen::Vector2d& xy, double near_z) const {
  if (sheets_.size() == 1) return 0;
  size_t best = 0;
  double best_miss = std::numeric_limits<double>::infinity();
  bool is_best_covering = false;
  for (size_t index = 0; index < sheets_.size(); ++index) {
    const bool is_covering = sheets_[index].Covers(xy);
    if (is_best_covering && !is_covering) continue;
    const double miss = std::abs(sheets_[index].height(xy) - near_z);
    if (miss >= best_miss && is_covering == is_best_covering) continue;
    best = index;
    best_miss = miss;
    is_best_covering = is_covering;
  }
  return best;
}

double Ground::Height(const Eigen::Vector2d& xy, double near_z) const {
  return sheets_[SheetAt(xy, near_z)].height(xy);
}

Eigen::Vector2d Ground::Gradient(const Eigen::Vector2d& xy, double near_z) const {
  constexpr double kReach = 1e-3;  // [m]; the error is of the order of its square
  const auto& height = sheets_[SheetAt(xy, near_z)].height;
  const Eigen::Vector2d x(kReach, 0), y(0, kReach);
  return Eigen::Vector2d(height(xy + x) - height(xy - x), height(xy + y) - height(xy - y)) /
         (2 * kReach);
}

Eigen::Vector3d Ground::Normal(const Eigen::Vector2d& xy, double near_z) const {
  const Eigen::Vector2d gradient = Gradient(xy, near_z);
  return Eigen::Vector3d(-gradient.x(), -gradient.y(), 1).normalized();
}

}  // namespace parkade::simulator

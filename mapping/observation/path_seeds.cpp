#include "mapping/observation/path_seeds.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr double kReach = 10.0;      // [m] from the car; the raster's half size
constexpr double kRasterCell = 0.1;  // [m]
constexpr double kMaxTravel = 25.0;  // [m] along the path, before and after
constexpr double kStep = 0.3;        // [m] between stamps
constexpr double kHalfWidth = 0.8;   // [m] of the path where the car's track is unknown
constexpr double kBeside = 0.7;      // [m] beside the car that is road, or it could not be here
constexpr int kRasterSize = static_cast<int>(2 * kReach / kRasterCell);

/// A square of the ground around the car.
class Raster {
 public:
  void StampDisc(const Eigen::Vector2d& center, double radius) {
    const auto cells = static_cast<int>(radius / kRasterCell);
    const int cx = CellOf(center.x()), cy = CellOf(center.y());
    for (int y = std::max(cy - cells, 0); y <= std::min(cy + cells, kRasterSize - 1); ++y)
      for (int x = std::max(cx - cells, 0); x <= std::min(cx + cells, kRasterSize - 1); ++x)
        if ((x - cx) * (x - cx) + (y - cy) * (y - cy) <= cells * cells) At(x, y) = 1;
  }

  bool IsSet(const Eigen::Vector2f& point) const {
    const int x = CellOf(point.x()), y = CellOf(point.y());
    return x >= 0 && y >= 0 && x < kRasterSize && y < kRasterSize &&
           cells_[static_cast<size_t>(y * kRasterSize + x)] != 0;
  }

 private:
  static int CellOf(double coordinate) {
    return static_cast<int>(std::floor((coordinate + kReach) / kRasterCell));
  }
  std::uint8_t& At(int x, int y) { return cells_[static_cast<size_t>(y * kRasterSize + x)]; }

  std::vector<std::uint8_t> cells_ =
      std::vector<std::uint8_t>(static_cast<size_t>(kRasterSize) * kRasterSize);
};

/// Stamps the contact areas of the poses from `begin` outwards until the path leaves the raster.
template <typename Iterator>
void StampPath(Iterator begin, Iterator end, const Rigid3& ground_from_odom,
               const Rigid3& body_from_ground, const WheelbaseFootprint& contact, Raster& raster) {
  const double radius = contact.track > 0 ? 0.5 * contact.track : kHalfWidth;
  double travel = 0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  bool is_first = true;
  for (Iterator state = begin; state != end; ++state) {
    const Rigid3 ground_from_then = ground_from_odom * state->world_from_body * body_from_ground;
    const Eigen::Vector3d& position = ground_from_then.translation;
    if (!is_first && (position - last).norm() < kStep) continue;
    if (!is_first) travel += (position - last).norm();
    if (travel > kMaxTravel || position.head<2>().norm() > kReach + contact.wheelbase) break;
    for (double along = 0; along <= contact.wheelbase; along += kStep)
      raster.StampDisc((ground_from_then * Eigen::Vector3d(along, 0, 0)).head<2>(), radius);
    last = position;
    is_first = false;
  }
}

}  // namespace

std::vector<std::uint8_t> FindPathSeeds(const GroundGrid& grid, const Trajectory& odom_from_body,
                                        Timestamp time, const Rigid3& body_from_ground,
                                        const WheelbaseFootprint& contact) {
  std::vector<std::uint8_t> seeds(grid.cells.size());
  const std::optional<Rigid3> now = odom_from_body.At(time);
  if (!now) return seeds;
  const Rigid3 ground_from_odom = (*now * body_from_ground).Inverse();
  const std::vector<TrajectoryState>& states = odom_from_body.states();
  const auto after =
      std::lower_bound(states.begin(), states.end(), time,
                       [](const TrajectoryState& state, Timestamp t) { return state.time < t; });
  Raster raster;
  StampPath(after, states.end(), ground_from_odom, body_from_ground, contact, raster);
  StampPath(std::make_reverse_iterator(after), states.rend(), ground_from_odom, body_from_ground,
            contact, raster);
  const double beside = contact.track > 0 ? kBeside : kHalfWidth;
  for (size_t i = 0; i < seeds.size(); ++i) {
    const GroundGridCell& cell = grid.cells[i];
    seeds[i] =
        cell.is_visible && (raster.IsSet(cell.point_in_ground) ||
                            contact.DistanceTo(cell.point_in_ground.cast<double>()) < beside);
  }
  return seeds;
}

}  // namespace parkade

#include "mapping/surface/free_clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "mapping/surface/ray_direction.h"
#include "mapping/surface/visibility_horizon.h"

namespace parkade {
namespace {

constexpr double kCell = 0.05;

/// Rows of ground with holes, ends, cells that are not free and some of two levels; one row is left
/// out.
SurfaceMap RaggedGround(unsigned seed, double share_missing) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  SurfaceMap surface{kCell, {}};
  for (int y = -120; y < 120; ++y) {
    if (y == 90) continue;
    const int begin = -120 + static_cast<int>(20 * share(random));
    for (int x = begin; x < 120; ++x) {
      if (share(random) < share_missing) continue;
      SurfaceCell cell;
      cell.x = x, cell.y = y;
      cell.free_belief = share(random) < share_missing ? 0.2F : 0.9F;
      surface.cells.push_back(cell);
      if (share(random) > 0.2 * share_missing) continue;
      cell.height = 3;
      surface.cells.push_back(cell);
    }
  }
  return surface;
}

bool IsFreeAndAlone(const SurfaceMap& surface, int x, int y) {
  const auto is_at = [&](const SurfaceCell& cell) { return cell.x == x && cell.y == y; };
  const auto found = std::find_if(surface.cells.begin(), surface.cells.end(), is_at);
  return found != surface.cells.end() && found->free_belief > 0.5F &&
         std::find_if(found + 1, surface.cells.end(), is_at) == surface.cells.end();
}

TEST(FreeClearance, IsFreeAsFarAsItSaysAndNoFarther) {
  const SurfaceMap surface = RaggedGround(4, 0.004);
  const CellFinder cells(surface);
  const FreeClearance clearance(cells);
  int greatest = 0;
  for (std::size_t i = 0; i < surface.cells.size(); i += 501) {
    const SurfaceCell& cell = surface.cells[i];
    const int radius = clearance.Around(cell);
    greatest = std::max(greatest, radius);
    bool is_free = true, is_free_beyond = true;
    for (int dy = -radius - 1; dy <= radius + 1; ++dy)
      for (int dx = -radius - 1; dx <= radius + 1; ++dx) {
        const bool is_here = IsFreeAndAlone(surface, cell.x + dx, cell.y + dy);
        is_free_beyond &= is_here;
        if (std::max(std::abs(dx), std::abs(dy)) <= radius) is_free &= is_here;
      }
    EXPECT_TRUE(is_free || radius == 0) << i;
    EXPECT_FALSE(is_free_beyond) << i;
  }
  EXPECT_GT(greatest, 4);
}

/// As FreeRays, step by step.
float WalkAlong(const Eigen::Vector2d& eye, int direction, double max_range,
                const CellFinder& cells) {
  const double angle = (direction + 0.5) / kNumRayDirections * 2 * M_PI - M_PI;
  const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
  double last_free = 0.8;
  const int num_steps = static_cast<int>(std::ceil((max_range - 0.8) / 0.1));
  for (int step = 0; step < num_steps; ++step) {
    const double range = 0.8 + step * 0.1;
    const Eigen::Vector2d place = eye + range * along;
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), 0});
    if (cell != nullptr && cell->free_belief > 0.5F) last_free = range;
    if (range - last_free >= 0.25) return static_cast<float>(last_free);
  }
  return static_cast<float>(max_range);
}

TEST(FreeRays, EndWhereAWalkStepByStepEnds) {
  for (const double share_missing : {0.0004, 0.003, 0.03, 0.4}) {
    const SurfaceMap surface = RaggedGround(1, share_missing);
    const CellFinder cells(surface);
    const FreeClearance clearance(cells);
    for (const Eigen::Vector2d& eye : {Eigen::Vector2d(0.3, 0.2), Eigen::Vector2d(-2, 4)}) {
      const FreeRays rays({Eigen::Quaterniond::Identity(), {eye.x(), eye.y(), 1}}, {}, 8,
                          clearance);
      for (int direction = 0; direction < kNumRayDirections; ++direction)
        ASSERT_EQ(rays.RangeAlong(direction), WalkAlong(eye, direction, 8, cells)) << direction;
    }
  }
}

}  // namespace
}  // namespace parkade

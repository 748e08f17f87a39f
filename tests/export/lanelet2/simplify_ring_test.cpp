#include "export/lanelet2/simplify_ring.h"

#include <gtest/gtest.h>

#include <random>

#include "export/lanelet2/cell_region.h"

namespace parkade {
namespace {

double Side(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool DoMeet(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
            const Eigen::Vector3d& d) {
  for (const int axis : {0, 1})
    if (std::max(a[axis], b[axis]) < std::min(c[axis], d[axis]) ||
        std::max(c[axis], d[axis]) < std::min(a[axis], b[axis]))
      return false;
  return Side(a, b, c) * Side(a, b, d) <= 0 && Side(c, d, a) * Side(c, d, b) <= 0;
}

bool IsSimple(const Ring& ring) {
  const size_t size = ring.size();
  for (size_t i = 0; i < size; ++i)
    for (size_t k = i + 2; k < size; ++k)
      if ((k + 1) % size != i && DoMeet(ring[i], ring[i + 1], ring[k], ring[(k + 1) % size]))
        return false;
  return true;
}

std::vector<bool> None(const Ring& ring) { return std::vector<bool>(ring.size(), false); }

/// A triangle whose long side goes up in stairs of `step`.
Ring Stairs(double step) {
  Ring ring = {{0, 0, 0}};
  for (int i = 10; i > 0; --i) {
    ring.emplace_back(i * step, (10 - i) * step, 0);
    ring.emplace_back(i * step, (11 - i) * step, 0);
  }
  ring.emplace_back(0, 10 * step, 0);
  return ring;
}

TEST(SimplerRings, HaveLinesInsteadOfStairs) {
  const Ring stairs = Stairs(0.05);

  const Ring inner = LeaveOutLeftBends(stairs, 0.05, None(stairs));
  const Ring outer = LeaveOutRightBends(stairs, 0.05, None(stairs));

  EXPECT_LE(inner.size(), 5U);
  EXPECT_LT(SignedArea(inner), SignedArea(stairs));
  EXPECT_LE(outer.size(), 5U);
  EXPECT_GT(SignedArea(outer), SignedArea(stairs));
}

TEST(SimplerRings, KeepWhatTheToleranceDoesNotAllowAndWhatIsFixed) {
  const Ring stairs = Stairs(0.05);
  EXPECT_EQ(LeaveOutLeftBends(stairs, 0.02, None(stairs)).size(), stairs.size());
  EXPECT_EQ(LeaveOutLeftBends(stairs, 0.05, std::vector<bool>(stairs.size(), true)), stairs);
}

TEST(SimplerRings, DoNotCrossThemselvesAndLieOnOneSide) {
  std::mt19937 random(4);
  constexpr double kCell = 0.05;
  int num_before = 0, num_after = 0;
  for (int trial = 0; trial < 40; ++trial) {
    CellRegion cells;  // corridors and niches, many of them a cell wide
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 30; ++x)
        if (random() % 100 < 70) cells = Unite(cells, {{y, x, x + 1}});
    for (const CellRegion& piece : SplitIntoPieces(cells)) {
      const Ring outline = TraceBoundary(piece, kCell).front();
      const Ring inner = LeaveOutLeftBends(outline, kCell, None(outline));
      const Ring outer = LeaveOutRightBends(outline, kCell, None(outline));

      EXPECT_TRUE(IsSimple(inner) && IsSimple(outer));
      EXPECT_LE(SignedArea(inner), SignedArea(outline) + 1e-12);
      EXPECT_GE(SignedArea(outer), SignedArea(outline) - 1e-12);
      num_before += static_cast<int>(outline.size());
      num_after += static_cast<int>(inner.size());
    }
  }
  EXPECT_LT(num_after, 0.8 * num_before);
}

}  // namespace
}  // namespace parkade

#include "tests/simulator/layouts/lot_ground.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade::simulator {
namespace {

/// Correlation of the grain of two floors (differences over 10 cm) on 6 m beside the middle of an
/// aisle, where nothing is painted.
double CorrelationOf(const GroundCanvas& a, const GroundCanvas& b, double aisle) {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  for (int i = 0; i < 120; ++i) {
    for (int k = 0; k < 24; ++k) {
      const float along = 8 + 0.05f * static_cast<float>(i),
                  across = static_cast<float>(aisle) + 0.6f + 0.05f * static_cast<float>(k);
      const auto grain = [&](const GroundCanvas& floor) {
        return Luminance(floor.Sample(along + 0.1f, across, 0.05f)) -
               Luminance(floor.Sample(along, across, 0.05f));
      };
      const double u = grain(a), v = grain(b);
      n += 1, x += u, y += v, xx += u * u, yy += v * v, xy += u * v;
    }
  }
  return (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
}

TEST(LotGround, NoDeckHasTheFloorOfAnother) {
  const LotLayout layout = PlanLot(3, 0);
  constexpr double kTexel = 0.05;
  const double aisle = layout.aisle_y[0];
  const auto deck = [&](std::uint64_t seed, int number) {
    return PaintDeck(layout, 1, kTexel, seed, number);
  };
  const GroundCanvas floor = deck(3, 1);
  EXPECT_GT(CorrelationOf(floor, deck(3, 1), aisle), 0.999);
  EXPECT_LT(std::abs(CorrelationOf(floor, deck(3, 0), aisle)), 0.3) << "of the same garage";
  EXPECT_LT(std::abs(CorrelationOf(floor, deck(4, 0), aisle)), 0.3) << "of the next seed's";
}

TEST(LotGround, TeesMarkTheEntrancesOfSlotsAlone) {
  const LotLayout layout = PlanLot(3, 0);
  constexpr double kTexel = 0.04;
  const GroundCanvas lines = PaintLot(layout, {}, kTexel, 3),
                     tees = PaintLot(layout, {}, kTexel, 3, SlotMarks::kTees);
  double at_middle[2] = {0, 0}, at_bar[2] = {0, 0};  // mean luminance
  for (const Rectangle& slot : layout.slots) {
    const Eigen::Vector2d into(std::cos(slot.yaw), std::sin(slot.yaw)), across(-into.y(), into.x());
    const Eigen::Vector2d side = slot.center + slot.half_size.y() * across,
                          bar = side - slot.half_size.x() * into - 0.3 * across;
    for (const int i : {0, 1}) {
      const GroundCanvas& ground = i == 0 ? lines : tees;
      const auto at = [&](const Eigen::Vector2d& place) {
        return static_cast<double>(Luminance(ground.Sample(static_cast<float>(place.x()),
                                                           static_cast<float>(place.y()), 0.05f))) /
               static_cast<double>(layout.slots.size());
      };
      at_middle[i] += at(side), at_bar[i] += at(bar);
    }
  }
  EXPECT_GT(at_middle[0], 2 * at_middle[1]);
  EXPECT_GT(at_bar[1], 2 * at_bar[0]);
}

}  // namespace
}  // namespace parkade::simulator

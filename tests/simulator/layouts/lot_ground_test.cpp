#include "tests/simulator/layouts/lot_ground.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/simulator/layouts/plan_place.h"

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

/// The ground of lot 3 as the options want it, but for its coarser texels.
GroundCanvas PaintLot3(const LotLayout& layout, SceneOptions options) {
  options.seed = 3;
  options.ground_texel = 0.04;
  return PaintLot(layout, {}, options);
}

TEST(LotGround, NoDeckHasTheFloorOfAnother) {
  const LotLayout layout = PlanLot(3, 0);
  constexpr double kTexel = 0.05;
  const double aisle = layout.aisle_y[0];
  const auto deck = [&](std::uint64_t seed, int number) {
    return PaintDeck(layout, 1, {.seed = seed, .ground_texel = kTexel}, number);
  };
  const GroundCanvas floor = deck(3, 1);
  EXPECT_GT(CorrelationOf(floor, deck(3, 1), aisle), 0.999);
  EXPECT_LT(std::abs(CorrelationOf(floor, deck(3, 0), aisle)), 0.3) << "of the same garage";
  EXPECT_LT(std::abs(CorrelationOf(floor, deck(4, 0), aisle)), 0.3) << "of the next seed's";
}

TEST(LotGround, TeesMarkTheEntrancesOfSlotsAlone) {
  const LotLayout layout = PlanLot(3, 0);
  const GroundCanvas lines = PaintLot3(layout, {}),
                     tees = PaintLot3(layout, {.slot_marks = "tees"});
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

/// Shares of places that a season changed, within 0.4 m of a kerb and beyond 4 m.
struct Rims {
  double at_kerb = 0, in_open = 0;
};

Rims ChangedBy(const std::string& season) {
  const LotLayout layout = PlanLot(3, 0);
  const GroundCanvas usual = PaintLot3(layout, {}), changed = PaintLot3(layout, {.season = season});
  double num_at_kerb = 0, num_in_open = 0;
  Rims rims;
  for (double x = 0.05; x < layout.length; x += 0.1) {
    for (double y = 0.05; y < layout.width; y += 0.1) {
      const double away = layout.FromKerb({x, y});
      if (away <= 0) continue;
      const auto at = [&](const GroundCanvas& canvas) {
        return Luminance(canvas.Sample(static_cast<float>(x), static_cast<float>(y), 0.04f));
      };
      const bool is_changed = std::abs(at(changed) - at(usual)) > 0.03f;
      if (away < 0.4) num_at_kerb += 1, rims.at_kerb += is_changed;
      if (away > 4) num_in_open += 1, rims.in_open += is_changed;
    }
  }
  return {rims.at_kerb / num_at_kerb, rims.in_open / num_in_open};
}

TEST(LotGround, SnowLiesAtKerbsAndLeavesMostlyThere) {
  const Rims snow = ChangedBy("winter"), leaves = ChangedBy("autumn");
  EXPECT_GT(snow.at_kerb, 0.9);
  EXPECT_LT(snow.in_open, 0.1);
  EXPECT_GT(leaves.at_kerb, 0.1);
  EXPECT_LT(leaves.in_open, 0.1 * leaves.at_kerb + 0.02);
}

TEST(LotGround, SnowHidesMarkings) {
  const LotLayout layout = PlanLot(3, 0);
  const auto num_marked = [&](const std::string& season) {
    const GroundCanvas canvas = PaintLot3(layout, {.season = season});
    int marked = 0;
    for (const Rectangle& slot : layout.slots)
      for (int step = -120; step < 120; ++step) {
        const Eigen::Vector2d into(std::cos(slot.yaw), std::sin(slot.yaw)),
            line = slot.center + 0.02 * step * into +
                   slot.half_size.y() * Eigen::Vector2d(-into.y(), into.x());
        marked += canvas.IsMarking(static_cast<float>(line.x()), static_cast<float>(line.y()));
      }
    return marked;
  };
  const int usual = num_marked("usual"), winter = num_marked("winter");
  EXPECT_LT(winter, 0.9 * usual);
  EXPECT_GT(winter, 0.4 * usual);
}

TEST(LotGround, DrainsLeaveTheRestAsItWas) {
  const LotLayout layout = PlanLot(3, 0);
  const GroundCanvas usual = PaintLot3(layout, {}),
                     drained = PaintLot3(layout, {.has_drains = true});
  double num = 0, num_changed = 0;
  for (float x = 0.05f; x < layout.length; x += 0.1f) {
    for (float y = 0.05f; y < layout.width; y += 0.1f) {
      num += 1;
      num_changed += Luminance(usual.Sample(x, y, 0.04f)) != Luminance(drained.Sample(x, y, 0.04f));
    }
  }
  EXPECT_GT(num_changed / num, 0.01);
  EXPECT_LT(num_changed / num, 0.06);
}

TEST(LotLayout, HeapsOfSnowLieInFreeSlotsAndAreNotDrivable) {
  for (int day = 0; day < 4; ++day) {
    const LotLayout lot = PlanLot({.seed = 5, .day = day, .season = "winter"}),
                    same = PlanLot({.seed = 5, .day = day});
    ASSERT_EQ(lot.heaps.size(), 3u);
    EXPECT_TRUE(same.heaps.empty());
    for (const Rectangle& heap : lot.heaps) {
      EXPECT_FALSE(lot.IsDrivable(heap.center));
      const Eigen::Vector2d along(std::cos(heap.yaw), std::sin(heap.yaw));
      EXPECT_FALSE(lot.IsDrivable(heap.center - 0.95 * heap.half_size.x() * along));
      EXPECT_TRUE(lot.IsDrivable(heap.Corner(0))) << "outside of the ellipse";
      EXPECT_TRUE(same.IsDrivable(heap.center)) << "a car stands there";
      EXPECT_TRUE(std::any_of(lot.slots.begin(), lot.slots.end(), [&](const Rectangle& slot) {
        return slot.SignedDistance(heap.center) < -heap.half_size.minCoeff() + 1e-9;
      }));
    }
  }
}

TEST(LotPlace, NobodyParksInAHeap) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const Place place = PlanPlace("lot", {.seed = seed, .season = "winter"});
    EXPECT_EQ(std::count_if(place.slots.begin(), place.slots.end(),
                            [](const ParkingSlot& slot) { return slot.is_blocked; }),
              3);
    const RoutePlan plan = place.plan_route({.length = 60, .ends_in_slot = true, .seed = seed});
    EXPECT_FALSE(plan.slot && plan.slot->is_blocked);
  }
}

}  // namespace
}  // namespace parkade::simulator

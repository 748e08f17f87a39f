#include "mapping/kerbs/kerb_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace parkade {
namespace {

using Eigen::Vector3d;

constexpr double kCarBegin = 10, kCarEnd = 15;  // [m] x

void SetClass(SurfaceCell& cell, SurfaceClass surface) {
  cell.class_beliefs = {};
  cell.class_beliefs[static_cast<std::size_t>(surface)] = 255;
  cell.free_belief = IsForCars(surface) ? 1.0F : 0.0F;
}

/// A street along x with a kerb at y = 0, and a car that hides 5 m of it. What lies behind it, and
/// beyond the stone, nobody saw.
struct Street {
  SurfaceMap surface;
  std::vector<NoKerb> no_kerbs = {};
  std::vector<Kerb> kerbs = {};

  explicit Street(bool has_car = true) {
    surface.cell_size = 0.1;
    for (int y = -40; y < 3; ++y)
      for (int x = 0; x < 300; ++x) {
        const double at = 0.1 * (x + 0.5);
        const bool is_beside_car = at > kCarBegin && at < kCarEnd && y >= -20;
        if (is_beside_car && (!has_car || y >= -10)) continue;
        SurfaceCell& cell = surface.cells.emplace_back();
        cell.x = x, cell.y = y;
        SetClass(cell, is_beside_car ? SurfaceClass::kVehicle
                       : y < 0       ? SurfaceClass::kDrivable
                                     : SurfaceClass::kKerb);
      }
  }

  /// The street lies on the left of one who walks toward smaller x.
  void AddKerb(double from, double to, double height = 0.12) {
    Kerb& kerb = kerbs.emplace_back();
    for (double x = from; x >= to; x -= 0.5) kerb.points.push_back(Vector3d(x, 0, 0));
    kerb.height = height;
    kerb.height_sigma = 0.01;
  }
  std::vector<Kerb> Close() {
    CloseGaps(surface, no_kerbs, kerbs);
    return kerbs;
  }
};

TEST(CloseGaps, AKerbGoesOnBehindAParkedCar) {
  Street street;
  street.AddKerb(25, kCarEnd, 0.11);
  street.AddKerb(kCarBegin, 2, 0.13);
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_NEAR(kerbs[0].height, 0.12, 1e-9);
  EXPECT_NEAR(kerbs[0].hidden_length, kCarEnd - kCarBegin, 0.5);
  EXPECT_NEAR(kerbs[0].points.front().x(), 30, 0.3) << "and on to where it was seen last";
  EXPECT_GE(kerbs[0].points.front().x(), 25);
  EXPECT_LE(kerbs[0].points.back().x(), 2);
  for (std::size_t i = 1; i < kerbs[0].points.size(); ++i)
    EXPECT_LT(kerbs[0].points[i].x(), kerbs[0].points[i - 1].x());
  for (const Vector3d& point : kerbs[0].points) EXPECT_NEAR(point.y(), 0, 0.05);
}

TEST(CloseGaps, WhereHeightsDifferSigmaSaysSo) {
  Street street;
  street.AddKerb(25, kCarEnd, 0.1);
  street.AddKerb(kCarBegin, 2, 0.13);
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_NEAR(kerbs[0].height_sigma, 0.015, 1e-6);
}

TEST(CloseGaps, AShortStraightKerbDoesNotTellWhereItLeads) {
  Street street;
  street.AddKerb(17, kCarEnd);
  EXPECT_EQ(street.Close()[0].points.back().x(), kCarEnd);
}

TEST(CloseGaps, NothingIsBelievedAcrossOpenGroundOrWhereNobodyLooked) {
  Street open;
  for (int y = -10; y < 20; ++y)
    for (int x = 115; x < 140; ++x) {
      SurfaceCell& cell = open.surface.cells.emplace_back();
      cell.x = x, cell.y = y;
      SetClass(cell, SurfaceClass::kDrivable);
    }
  std::ranges::sort(open.surface.cells, {},
                    [](const SurfaceCell& cell) { return std::pair(cell.y, cell.x); });
  Street unseen(/*has_car=*/false);
  for (Street* street : {&open, &unseen}) {
    street->AddKerb(25, kCarEnd);
    street->AddKerb(kCarBegin, 2);
    EXPECT_EQ(street->Close().size(), 2U);
  }
}

TEST(CloseGaps, WhereAnOutlineWithoutKerbGoesAlongThereIsNone) {
  Street street;
  street.AddKerb(25, kCarEnd);
  street.AddKerb(kCarBegin, 2);
  for (double x = 11; x < 14; x += 0.5) street.no_kerbs.push_back({{x, -0.1, 0}, {-1, 0}});
  EXPECT_EQ(street.Close().size(), 2U);
  street = Street();
  street.AddKerb(25, kCarEnd);
  street.AddKerb(kCarBegin, 2);
  for (double y = -3; y < 0; y += 0.5) street.no_kerbs.push_back({{12, y, 0}, {0, 1}});
  EXPECT_EQ(street.Close().size(), 1U) << "the flank of a car says nothing";
}

TEST(CloseGaps, KerbsOfOtherHeightsStayApart) {
  Street street;
  street.AddKerb(25, kCarEnd, 0.06);
  street.AddKerb(kCarBegin, 2, 0.16);
  EXPECT_EQ(street.Close().size(), 2U);
}

TEST(CloseGaps, AKerbGrowsToTheLastPlaceThatLooksLikeOne) {
  Street street;
  std::erase_if(street.surface.cells, [](const SurfaceCell& cell) { return cell.x < 80; });
  street.AddKerb(25, kCarEnd);
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_NEAR(kerbs[0].points.back().x(), 8, 0.3);
  EXPECT_NEAR(kerbs[0].hidden_length, kCarEnd - kCarBegin, 0.5);
}

TEST(CloseGaps, WhatHooksAroundTheCornerOfACarIsCutOff) {
  Street street;
  street.AddKerb(25, kCarEnd);
  street.kerbs[0].points.insert(street.kerbs[0].points.end(), {{14.9, -0.4, 0}, {14.9, -0.9, 0}});
  street.AddKerb(kCarBegin, 2);
  street.kerbs[1].points.insert(street.kerbs[1].points.begin(), {{10.1, -0.9, 0}, {10.1, -0.4, 0}});
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 1U);
  for (const Vector3d& point : kerbs[0].points) EXPECT_NEAR(point.y(), 0, 0.1);
  for (std::size_t i = 1; i < kerbs[0].points.size(); ++i)
    EXPECT_LT(kerbs[0].points[i].x(), kerbs[0].points[i - 1].x());
}

TEST(CloseGaps, AnotherDeckHasNoSay) {
  Street street;
  street.AddKerb(25, kCarEnd);
  street.AddKerb(kCarBegin, 2);
  Kerb above = street.kerbs[0];
  for (Vector3d& point : above.points) point += Vector3d(-10, 0.1, 3);
  street.kerbs.push_back(above);
  for (double x = 11; x < 14; x += 0.5) street.no_kerbs.push_back({{x, -0.1, 3}, {-1, 0}});
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 2U);
  for (const Kerb& kerb : kerbs)
    for (const Vector3d& point : kerb.points) EXPECT_NEAR(point.z(), kerb.points[0].z(), 0.01);
}

TEST(CloseGaps, RoundCornersLeadNowhere) {
  Street street;
  Kerb& kerb = street.kerbs.emplace_back();
  for (double angle = 0; angle < 1.6; angle += 0.1)  // radius 5 m, its end along the street
    kerb.points.push_back(
        Vector3d(kCarEnd + 5 * std::sin(1.6 - angle), 5 - 5 * std::cos(1.6 - angle), 0));
  kerb.height = 0.12, kerb.height_sigma = 0.01;
  const std::vector<Vector3d> points = kerb.points;
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_EQ(kerbs[0].points, points);
  EXPECT_EQ(kerbs[0].hidden_length, 0);
}

TEST(CloseGaps, AnIslandWithACarBesideItIsClosed) {
  Street street;
  Kerb& kerb = street.kerbs.emplace_back();  // from the car around the island to the car
  for (double x = kCarBegin; x > 2; x -= 0.5) kerb.points.push_back(Vector3d(x, 0, 0));
  for (double y = 0; y < 3; y += 0.5) kerb.points.push_back(Vector3d(2, y, 0));
  for (double x = 2; x < 25; x += 0.5) kerb.points.push_back(Vector3d(x, 3, 0));
  for (double y = 3; y > 0; y -= 0.5) kerb.points.push_back(Vector3d(25, y, 0));
  for (double x = 25; x >= kCarEnd; x -= 0.5) kerb.points.push_back(Vector3d(x, 0, 0));
  kerb.height = 0.12, kerb.height_sigma = 0.01;
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_EQ(kerbs[0].points.front(), kerbs[0].points.back());
  EXPECT_NEAR(kerbs[0].hidden_length, kCarEnd - kCarBegin, 0.5);
  EXPECT_NEAR(kerbs[0].Length(), 2 * (23 + 3), 0.5);
}

/// An island of 10 m x 2 m from x = 10 on; a car stands close to its side at y = 0 and hides the
/// stone there.
Street StreetWithIsland(SurfaceClass on_island) {
  Street street;
  street.surface.cells.resize(0);
  for (int y = -30; y < 60; ++y)
    for (int x = 0; x < 300; ++x) {
      const bool is_beside = x >= 95 && x < 205 && y >= -20 && y < -2,
                 is_island = x >= 100 && x < 200 && y >= 0 && y < 20;
      const bool is_unseen = x >= 95 && x < 205 && y >= -2 && y < 0;
      if (is_unseen) continue;
      SurfaceCell& cell = street.surface.cells.emplace_back();
      cell.x = x, cell.y = y;
      SetClass(cell, is_beside   ? SurfaceClass::kVehicle
                     : is_island ? on_island
                                 : SurfaceClass::kDrivable);
    }
  Kerb& kerb = street.kerbs.emplace_back();  // the ground lies on its left: around it clockwise
  for (double y = 0.5; y < 2; y += 0.25) kerb.points.push_back(Vector3d(10, y, 0));
  for (double x = 10; x < 20; x += 0.5) kerb.points.push_back(Vector3d(x, 2, 0));
  for (double y = 2; y > 0.1; y -= 0.25) kerb.points.push_back(Vector3d(20, y, 0));
  for (const Vector3d& corner : {Vector3d(19.9, 0.1, 0), Vector3d(19.7, 0, 0)})
    kerb.points.push_back(corner);
  kerb.height = 0.12, kerb.height_sigma = 0.01;
  return street;
}

TEST(CloseGaps, TheSideOfAnIslandThatACarHidesIsFoundAroundTheCorner) {
  for (const SurfaceClass on_island :
       {SurfaceClass::kKerb, SurfaceClass::kVegetation, SurfaceClass::kPavement}) {
    Street street = StreetWithIsland(on_island);
    const std::vector<Kerb> kerbs = street.Close();
    ASSERT_EQ(kerbs.size(), 1U);
    EXPECT_GT(kerbs[0].Length(), 2 * 10 + 3) << NameOf(on_island);
    const auto is_on_side = [](const Vector3d& point) {
      return point.x() > 11 && point.x() < 19 && std::abs(point.y()) < 0.15;
    };
    EXPECT_GT(std::ranges::count_if(kerbs[0].points, is_on_side), 20);
    const bool is_stone_seen = on_island == SurfaceClass::kKerb;
    EXPECT_NEAR(kerbs[0].hidden_length, is_stone_seen ? 0 : 10, 1.5);
  }
  EXPECT_LT(StreetWithIsland(SurfaceClass::kStructure).Close()[0].Length(), 2 * 10)
      << "that is a wall";
}

TEST(CloseGaps, AClosedKerbAroundAnIslandStaysAsItIs) {
  Street street;
  Kerb& kerb = street.kerbs.emplace_back();
  for (int i = 0; i <= 40; ++i) {
    const double angle = i * std::numbers::pi / 20;
    kerb.points.push_back(Vector3d(20 + 2 * std::cos(angle), -2 + 2 * std::sin(angle), 0));
  }
  kerb.height = 0.12, kerb.height_sigma = 0.01;
  const std::vector<Vector3d> points = kerb.points;
  const std::vector<Kerb> kerbs = street.Close();
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_EQ(kerbs[0].points, points);

  Street with_corners;  // and its ends overlap
  with_corners.kerbs.emplace_back() = {
      {{20, 0, 0}, {2, 0, 0}, {2, 3, 0}, {25, 3, 0}, {25, 0, 0}, {19.9, 0, 0}}, 0.12, 0.01};
  const double length = with_corners.kerbs[0].Length();
  EXPECT_EQ(with_corners.Close()[0].Length(), length);
}

}  // namespace
}  // namespace parkade

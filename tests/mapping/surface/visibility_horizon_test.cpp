#include "mapping/surface/visibility_horizon.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

constexpr double kCell = 0.05;

/// Free ground of 20 m on each side, at height 0.1 x, but for a box (a car) and what lies behind
/// nobody knows.
SurfaceMap GroundWithout(const Eigen::AlignedBox2d& box) {
  SurfaceMap surface{kCell, {}};
  for (int y = -200; y < 200; ++y)
    for (int x = -200; x < 200; ++x) {
      const Eigen::Vector2d middle = kCell * Eigen::Vector2d(x + 0.5, y + 0.5);
      SurfaceCell cell;
      cell.x = x, cell.y = y;
      cell.height = static_cast<float>(0.1 * middle.x());
      cell.free_belief = box.contains(middle) ? 0.1F : 0.9F;
      surface.cells.push_back(cell);
    }
  return surface;
}

VisibilityHorizon LookFrom(const Eigen::Vector2d& place, const SurfaceMap& surface) {
  const Eigen::Quaterniond uphill(Eigen::AngleAxisd(-std::atan(0.1), Eigen::Vector3d::UnitY()));
  const Rigid3 site_from_ground{uphill, {place.x() - 1, place.y(), 0.1 * (place.x() - 1)}};
  const Rigid3 site_from_camera{Eigen::Quaterniond::Identity(),
                                {place.x(), place.y(), 0.1 * place.x() + 1}};
  return VisibilityHorizon(site_from_camera, site_from_ground, 8, CellFinder(surface));
}

TEST(VisibilityHorizon, WhatStandsOnItHidesTheGroundBehind) {
  const SurfaceMap surface = GroundWithout({Eigen::Vector2d(3, -1), Eigen::Vector2d(5, 1)});
  const Eigen::Vector2d eye(0, 0);
  const VisibilityHorizon open = LookFrom(eye, surface);

  EXPECT_TRUE(open.Shows(eye, {2.9, 0})) << "before it";
  EXPECT_FALSE(open.Shows(eye, {6, 0}));
  EXPECT_FALSE(open.Shows(eye, {6, 1.7}));
  EXPECT_TRUE(open.Shows(eye, {5.5, 2.2})) << "beside it";
  EXPECT_TRUE(open.Shows(eye, {-6, 0})) << "on the other side";
  EXPECT_FALSE(open.Shows(eye, {-9, 0})) << "out of range";
}

TEST(VisibilityHorizon, APinholeHidesNothing) {
  const SurfaceMap surface = GroundWithout({Eigen::Vector2d(3, -1), Eigen::Vector2d(3.15, 1)});
  EXPECT_TRUE(LookFrom({0, 0}, surface).Shows({0, 0}, {6, 0}));
}

TEST(VisibilityHorizon, WithoutASurfaceEverythingIsOpen) {
  EXPECT_TRUE(VisibilityHorizon().Shows({0, 0}, {100, 0}));
}

}  // namespace
}  // namespace parkade

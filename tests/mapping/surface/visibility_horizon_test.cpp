#include "mapping/surface/visibility_horizon.h"

#include <gtest/gtest.h>

#include <cmath>

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
  const CellFinder cells(surface);
  return VisibilityHorizon(FreeRays(site_from_camera, site_from_ground, 8, FreeClearance(cells)));
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

/// What one image shows on rays of a degree: something from 4 m on in the directions up to 5
/// degrees to each side, else free ground.
PosedGroundPatch PatchWith(SurfaceClass standing) {
  PosedGroundPatch posed;
  for (double angle = -180; angle < 180; angle += 0.7)
    for (double range = 1; range < 8; range += 0.1) {
      GroundSample sample;
      sample.point_in_body =
          Eigen::Vector3f(Eigen::Vector3d(range * std::cos(angle * M_PI / 180),
                                          range * std::sin(angle * M_PI / 180), 0)
                              .cast<float>());
      const bool stands = std::abs(angle) < 5 && range >= 4;
      sample.is_free = !stands;
      sample.surface = stands ? standing : SurfaceClass::kDrivable;
      posed.patch.samples.push_back(sample);
    }
  return posed;
}

TEST(VisibilityHorizon, WhoWalksByHidesTheGroundBehindInThatImage) {
  const SurfaceMap surface = GroundWithout({});
  const Eigen::Vector2d eye(0, 0);
  VisibilityHorizon open = LookFrom(eye, surface);
  ASSERT_TRUE(open.Shows(eye, {6, 0}));

  open.HideBehind(PatchWith(SurfaceClass::kPerson), eye);

  EXPECT_TRUE(open.Shows(eye, {3.7, 0}));
  EXPECT_FALSE(open.Shows(eye, {4.5, 0}));
  EXPECT_FALSE(open.Shows(eye, {7, 0.3}));
  EXPECT_TRUE(open.Shows(eye, {6, 1.5})) << "beside it";
}

TEST(VisibilityHorizon, LowThingsAndSpecksHideNothing) {
  const SurfaceMap surface = GroundWithout({});
  const Eigen::Vector2d eye(0, 0);
  VisibilityHorizon open = LookFrom(eye, surface);
  open.HideBehind(PatchWith(SurfaceClass::kPavement), eye);
  EXPECT_TRUE(open.Shows(eye, {6, 0}));
  PosedGroundPatch speck = PatchWith(SurfaceClass::kDrivable);
  for (GroundSample& sample : speck.patch.samples) sample.is_free = true;
  speck.patch.samples[1000].is_free = false;
  speck.patch.samples[1000].surface = SurfaceClass::kStructure;
  open.HideBehind(speck, eye);
  for (double angle = -3; angle < 3; angle += 0.05)
    EXPECT_TRUE(open.Shows(eye, {7 * std::cos(angle), 7 * std::sin(angle)}));
}

TEST(VisibilityHorizon, WithoutASurfaceEverythingIsOpen) {
  EXPECT_TRUE(VisibilityHorizon().Shows({0, 0}, {100, 0}));
}

}  // namespace
}  // namespace parkade

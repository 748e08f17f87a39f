#include "mapping/kerbs/find_kerbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "mapping/kerbs/kerb_looks.h"
#include "mapping/kerbs/kerb_sweep.h"
#include "mapping/kerbs/outline_strips.h"

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBorder = 3.0;     // [m] y at which the drivable ground ends
constexpr double kEyeHeight = 1.0;  // [m]

/// Gray values of something that shows a pattern everywhere.
double Pattern(double x, double y) {
  return 14 * (std::sin(9 * x + 3 * y) + std::sin(6 * x - 11 * y) + std::sin(14 * x + 8 * y));
}

/// What stands at the border: its front rises from `bottom` to `top`, then it is level. Between the
/// ground and `bottom` it is dark.
struct Border {
  double bottom = 0, top = 0.12;  ///< [m] above the ground
  bool is_plain = false;          ///< nothing but its color is seen of it
  double stone = 0;  ///< [m] width of a bright stone along it; what lies behind is nearly plain
};

/// What a ray from `eye` through `point` of the plane z = 0 sees. The ground lies at z = 0 too.
double GrayAlong(const Vector3d& eye, const Vector3d& point, const Border& border) {
  const Vector3d ray = point - eye;
  if (point.y() < kBorder) return 90 + 0.3 * Pattern(point.x(), point.y());
  const Vector3d front = eye + (kBorder - eye.y()) / ray.y() * ray;
  if (front.z() < border.bottom) return 20;
  if (border.is_plain) return 130;
  if (front.z() < border.top) return 70 + Pattern(front.x(), 5 * front.z());
  const Vector3d level = eye + (border.top - eye.z()) / ray.z() * ray;
  if (border.stone == 0) return 130 + Pattern(level.x(), level.y());
  // Views blur what is far from them.
  const double blur = 0.02 * (level - eye).norm();
  const double share = std::clamp((kBorder + border.stone - level.y()) / blur + 0.5, 0.0, 1.0);
  return 120 + 0.03 * Pattern(level.x(), level.y()) +
         share * (60 + 0.5 * Pattern(level.x(), level.y()));
}

/// Three cameras at different heights and distances look to their left while the car drives along y
/// = 0. `off` [m]: by which its poses are wrong.
struct DrawnDrive {
  std::vector<PosedGroundPatch> patches;
  DrivenPath path;

  explicit DrawnDrive(const Border& border, int drive = 0, const Vector3d& off = {0, 0, 0}) {
    path.drive = drive;
    path.cameras_in_body = {
        {0, 0.8, kEyeHeight}, {2, 0, 0.8 * kEyeHeight}, {-1, 0.4, 1.1 * kEyeHeight}};
    for (int camera = 0; camera < 3; ++camera)
      for (double x = 0; x <= 12; x += 1) {
        PosedGroundPatch posed{{.drive = drive, .camera = camera, .time = {}, .samples = {}}, {}};
        posed.site_from_body.translation.x() = x;
        const Vector3d eye = path.cameras_in_body[static_cast<size_t>(camera)] + Vector3d(x, 0, 0);
        for (double gx = eye.x() - 5; gx <= eye.x() + 5; gx += 0.06)
          for (double gy = 1.8; gy <= 5; gy += 0.06) {
            GroundSample sample;
            sample.point_in_body = Eigen::Vector3f(Vector3d(gx - x, gy, 0).cast<float>());
            const double gray =
                GrayAlong(eye, {gx, gy, 0}, border) + 5 * camera;  // exposures differ
            sample.blue = sample.green = sample.red = static_cast<std::uint8_t>(std::lround(gray));
            sample.is_free = gy < kBorder;
            sample.confidence = gy < kBorder + 1 ? 1.0F : 0.0F;
            posed.patch.samples.push_back(sample);
          }
        posed.site_from_body.translation += off;
        patches.push_back(std::move(posed));
      }
  }
};

/// The map of the ground, `height` [m] off.
struct DrawnGround {
  SurfaceMap surface;
  TriangleMesh mesh;

  explicit DrawnGround(double height = 0) {
    surface.cell_size = 0.1;
    for (int y = -20; y < 30; ++y)
      for (int x = -40; x < 160; ++x)
        surface.cells.push_back(
            {.x = x, .y = y, .height = static_cast<float>(height), .free_belief = 1});
    const auto z = static_cast<float>(height);
    mesh.vertices = {{-4, -2, z}, {16, -2, z}, {16, kBorder, z}, {-4, kBorder, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  }
};

/// A stone of 20 cm in front of a lawn, as a network sees it.
void DrawKerb(SurfaceMap& surface) {
  for (SurfaceCell& cell : surface.cells) {
    const double y = (cell.y + 0.5) * surface.cell_size;
    const SurfaceClass shown = y < kBorder         ? SurfaceClass::kDrivable
                               : y < kBorder + 0.2 ? SurfaceClass::kKerb
                                                   : SurfaceClass::kVegetation;
    cell.class_beliefs[static_cast<std::size_t>(shown)] = 255;
    cell.free_belief = y < kBorder ? 1.0F : 0.0F;
  }
}

std::vector<Kerb> FindByLook(const Border& border) {
  const DrawnDrive drive(border);
  DrawnGround ground;
  for (int y = 30; y < 50; ++y)
    for (int x = -40; x < 160; ++x) ground.surface.cells.push_back({.x = x, .y = y});
  DrawKerb(ground.surface);
  return FindKerbs(ground.mesh, ground.surface, PatchesInMemory(drive.patches),
                   std::span(&drive.path, 1));
}

std::vector<Kerb> Find(const Border& border, double height_error = 0) {
  const DrawnDrive drive(border);
  const DrawnGround ground(height_error);
  return FindKerbs(ground.mesh, ground.surface, PatchesInMemory(drive.patches),
                   std::span(&drive.path, 1));
}

// Drives lie centimeters off each other, and other days have other shadows.
TEST(SweepStrips, HoldsTheViewsOfEachDriveAgainstEachOtherAlone) {
  const Border border;
  const DrawnDrive monday(border, 0), friday(border, 1, {0.1, -0.04, 0.01});
  std::vector<PosedGroundPatch> both = monday.patches;
  both.insert(both.end(), friday.patches.begin(), friday.patches.end());
  const std::vector<DrivenPath> paths = {monday.path, friday.path};
  const DrawnGround ground;
  std::vector<OutlineStrip> strips = CutOutline(ground.mesh, ground.surface, 0.5);
  std::erase_if(strips, [](const OutlineStrip& strip) {
    return std::abs(strip.foot.y() - kBorder) > 0.02 || strip.foot.x() > -1;  // few views
  });
  const StripWindow window;
  const auto sweep = [&](std::span<const PosedGroundPatch> patches) {
    return SweepStrips(strips, 0.5, PatchesInMemory(patches), paths, std::span(&window, 1))[0];
  };

  const std::vector<SweptStrip> first = sweep(monday.patches), second = sweep(friday.patches),
                                sum = sweep(both);

  ASSERT_GT(strips.size(), 2U);
  for (std::size_t i = 0; i < strips.size(); ++i) {
    EXPECT_EQ(sum[i].num_views, first[i].num_views + second[i].num_views);
    ASSERT_FALSE(sum[i].near_outline.empty());
    for (std::size_t k = 0; k < sum[i].near_outline.size(); ++k) {
      const Agreement &one = first[i].near_outline[k], &other = second[i].near_outline[k];
      EXPECT_FLOAT_EQ(sum[i].near_outline[k].residual, one.residual + other.residual);
      EXPECT_FLOAT_EQ(sum[i].near_outline[k].total, one.total + other.total);
      EXPECT_EQ(sum[i].near_outline[k].num_cells, one.num_cells + other.num_cells);
    }
    EXPECT_GT(sum[i].parallax, 0.9 * std::min(first[i].parallax, second[i].parallax));
    EXPECT_LT(sum[i].parallax, 1.1 * std::max(first[i].parallax, second[i].parallax));
  }
}

TEST(FindKerbs, MeasuresAStepUpToSomethingLevel) {
  for (const double height : {0.08, 0.12, 0.16}) {
    const std::vector<Kerb> kerbs = Find({.bottom = 0, .top = height});
    ASSERT_EQ(kerbs.size(), 1U) << height;
    EXPECT_NEAR(kerbs[0].height, height, 0.01);
    EXPECT_LT(kerbs[0].height_sigma, 0.015);
    EXPECT_GT(kerbs[0].Length(), 9);
    for (const Vector3d& point : kerbs[0].points) {
      const bool is_at_corner = point.x() < -3 || point.x() > 15;
      EXPECT_NEAR(point.y(), kBorder, is_at_corner ? 0.06 : 0.02);
      EXPECT_NEAR(point.z(), 0, 0.005);
    }
    EXPECT_LT(kerbs[0].points.back().x(), kerbs[0].points.front().x())
        << "the ground lies on its left";
  }
}

TEST(FindKerbs, TheEdgeOfABrightStoneBeforePlainGroundHidesNoHeight) {
  for (const double height : {0.1, 0.14}) {
    const std::vector<Kerb> kerbs = FindByLook({.bottom = 0, .top = height, .stone = 0.15});
    ASSERT_EQ(kerbs.size(), 1U) << height;
    EXPECT_NEAR(kerbs[0].height, height, 0.015);
  }
}

TEST(FindKerbs, MeasuresFromTheGroundThatIsSeenAndNotFromTheMapsError) {
  const std::vector<Kerb> kerbs = Find({.bottom = 0, .top = 0.1}, -0.03);
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_NEAR(kerbs[0].height, 0.1, 0.012);
}

TEST(FindKerbs, WhatLooksLikeOneHasTheHeightThatIsUsualWhereNothingTellsIt) {
  const Border plain{.bottom = 0, .top = 0.12, .is_plain = true};
  EXPECT_TRUE(Find(plain).empty());
  const std::vector<Kerb> kerbs = FindByLook(plain);
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_NEAR(kerbs[0].height, 0.12, 0.03);
  EXPECT_GT(kerbs[0].height_sigma, 0.025);
  EXPECT_GT(kerbs[0].Length(), 9);
}

TEST(FindKerbs, WhatLooksLikeOneAndIsSeenToBeFlatIsNone) {
  EXPECT_TRUE(FindByLook({.bottom = 0, .top = 0}).empty());
}

TEST(FindKerbs, WhatLooksLikeOneIsMeasuredWhereItCanBe) {
  const std::vector<Kerb> kerbs = FindByLook({.bottom = 0, .top = 0.16});
  ASSERT_EQ(kerbs.size(), 1U);
  EXPECT_NEAR(kerbs[0].height, 0.16, 0.012);
  EXPECT_LT(kerbs[0].height_sigma, 0.02);
}

TEST(LookBeyond, TellsKerbsFromWhatIsNoneAndFromWhatNobodySaw) {
  DrawnGround ground;
  const std::vector<OutlineStrip> strips = CutOutline(ground.mesh, ground.surface, 0.5);
  const auto looks_at_border = [&] {
    const std::vector<KerbLook> looks = LookBeyond(strips, 0.5, ground.surface);
    std::set<KerbLook> found;
    for (std::size_t i = 0; i < strips.size(); ++i)
      if (std::abs(strips[i].foot.y() - kBorder) < 0.02) found.insert(looks[i]);
    return found;
  };
  EXPECT_EQ(looks_at_border(), std::set{KerbLook::kUnknown}) << "no network told classes";
  for (int y = 30; y < 50; ++y)
    for (int x = -40; x < 160; ++x) ground.surface.cells.push_back({.x = x, .y = y});
  DrawKerb(ground.surface);
  EXPECT_EQ(looks_at_border(), std::set{KerbLook::kKerb});
  for (SurfaceCell& cell : ground.surface.cells) {
    cell.class_beliefs = {};
    cell.class_beliefs[static_cast<std::size_t>(SurfaceClass::kStructure)] = 255;
  }
  EXPECT_EQ(looks_at_border(), std::set{KerbLook::kNone});
}

TEST(FindKerbs, AFlatChangeOfColorIsNone) { EXPECT_TRUE(Find({.bottom = 0, .top = 0}).empty()); }

TEST(FindKerbs, AWallIsNone) { EXPECT_TRUE(Find({.bottom = 0, .top = 3}).empty()); }

TEST(FindKerbs, TheSillOfACarIsNone) { EXPECT_TRUE(Find({.bottom = 0.2, .top = 1.4}).empty()); }

TEST(FindKerbs, WhereNothingWasSeenBeyondTheOutlineThereIsNone) {
  DrawnDrive drive({.bottom = 0, .top = 0.12});
  for (PosedGroundPatch& posed : drive.patches)
    std::erase_if(posed.patch.samples, [](const GroundSample& sample) { return !sample.is_free; });
  const DrawnGround ground;
  EXPECT_TRUE(FindKerbs(ground.mesh, ground.surface, PatchesInMemory(drive.patches),
                        std::span(&drive.path, 1))
                  .empty());
  EXPECT_TRUE(FindKerbs({}, {}, PatchesInMemory({}), {}).empty());
}

TEST(FindKerbs, RefusesHeightsThatCannotBe) {
  KerbOptions options;
  options.min_height = 0.5;
  EXPECT_THROW(options.Validate(), Error);
}

TEST(CutOutline, GivesStripsOnTheGroundWithItOnTheirLeft) {
  DrawnGround ground;
  for (SurfaceCell& cell : ground.surface.cells)
    cell.height = 0.02F * (static_cast<float>(cell.x) + 0.5F) * 0.1F;
  const std::vector<OutlineStrip> strips = CutOutline(ground.mesh, ground.surface, 1.0);
  ASSERT_GT(strips.size(), 35U);
  int num_at_border = 0;
  for (const OutlineStrip& strip : strips) {
    EXPECT_NEAR(strip.foot.z(), 0.02 * strip.foot.x(), 0.002);
    EXPECT_NEAR(strip.slope, 0.02 * strip.along.x(), 0.002);
    EXPECT_NEAR(strip.slope_outward, 0.02 * strip.Outward().x(), 0.002);
    if (std::abs(strip.foot.y() - kBorder) > 0.05 || std::abs(strip.along.x()) < 0.9) continue;
    ++num_at_border;
    EXPECT_GT(strip.Outward().y(), 0.9);
  }
  EXPECT_GE(num_at_border, 15);
}

TEST(CutOutline, LeavesRaggedOutlinesOut) {
  DrawnGround ground;
  ground.mesh.vertices.clear();
  ground.mesh.triangles.clear();
  // Teeth of 30 cm along the border.
  for (int i = 0; i <= 40; ++i) {
    const auto x = static_cast<float>(0.25 * i);
    ground.mesh.vertices.push_back({x, 0, 0});
    ground.mesh.vertices.push_back({x, i % 2 == 0 ? 2.7F : 3.0F, 0});
    const auto last = static_cast<std::uint32_t>(2 * i);
    if (i > 0)
      ground.mesh.triangles.insert(ground.mesh.triangles.end(),
                                   {{last - 2, last, last - 1}, {last, last + 1, last - 1}});
  }
  for (const OutlineStrip& strip : CutOutline(ground.mesh, ground.surface, 1.0))
    EXPECT_LT(strip.foot.y(), 2.5) << "at the sides and at the bottom it is straight";
}

}  // namespace
}  // namespace parkade

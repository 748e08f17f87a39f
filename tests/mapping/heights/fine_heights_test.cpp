#include "mapping/heights/fine_heights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace parkade {
namespace {

constexpr double kEyeHeight = 1.0;  // [m]

using PlaneFunction = std::function<double(double x, double y)>;

/// What cameras above (x, 0) see of a ground, put onto the plane z = 0 on which their car stands.
std::vector<PosedGroundPatch> LookAt(const PlaneFunction& height, const PlaneFunction& gray,
                                     bool is_free = true) {
  std::vector<PosedGroundPatch> patches;
  for (double x = 0; x <= 12; x += 0.4) {
    PosedGroundPatch posed{{.drive = 0, .camera = 0, .time = {}, .samples = {}}, {}};
    posed.site_from_body.translation.x() = x;
    for (double gx = x - 5; gx <= x + 5; gx += 0.06)
      for (double gy = 1.5; gy <= 6; gy += 0.06) {
        const double stretch = kEyeHeight / (kEyeHeight - height(gx, gy));
        GroundSample sample;
        sample.point_in_body =
            Eigen::Vector3f(Eigen::Vector3d(stretch * (gx - x), stretch * gy, 0).cast<float>());
        sample.blue = sample.green = sample.red =
            static_cast<std::uint8_t>(std::lround(gray(gx, gy)));
        sample.is_free = is_free;
        posed.patch.samples.push_back(sample);
      }
    patches.push_back(std::move(posed));
  }
  return patches;
}

double Texture(double x, double y) {
  return 120 + 20 * (std::sin(7 * x + 3 * y) + std::sin(5 * x - 9 * y) + std::sin(13 * x + 4 * y));
}

double Kerb(double, double y) { return y < 4 ? 0 : 0.1; }

std::vector<HeightObservation> Measure(const std::vector<PosedGroundPatch>& patches) {
  DrivenPath path;
  path.cameras_in_body.emplace_back(0, 0, kEyeHeight);
  std::vector<HeightObservation> level;
  for (double x = -8; x < 20; x += 0.4)
    for (double y = -2; y < 10; y += 0.4) level.push_back({{x, y, 0}, 100});
  return MeasureFineHeights(PatchesInMemory(patches), std::span(&path, 1), HeightField(level, {}),
                            {});
}

TEST(FineHeights, AKerbIsAStep) {
  for (const bool is_free : {true, false}) {
    int num_low = 0, num_high = 0;
    for (const HeightObservation& found : Measure(LookAt(Kerb, Texture, is_free))) {
      const double x = found.point_in_site.x(), y = found.point_in_site.y(),
                   z = found.point_in_site.z();
      if (x < 1 || x > 11) continue;
      EXPECT_GT(found.weight, 0);
      EXPECT_LE(found.sigma, 0.06);
      const bool is_low = y > 1.7 && y<3.7, is_high = y> 4.3 && y < 5.5;
      num_low += is_low;
      num_high += is_high;
      if (!is_low && !is_high) continue;
      EXPECT_NEAR(z, is_low ? 0 : 0.1, 0.025) << y;
    }
    // Of 25 windows along and 5 or 3 across.
    EXPECT_GT(num_low, 100) << is_free;
    EXPECT_GT(num_high, 60) << "what is no free ground has a height, too: " << is_free;
  }
}

TEST(FineHeights, GroundThatShowsNothingHasNone) {
  EXPECT_TRUE(Measure(LookAt(Kerb, [](double, double) { return 120; })).empty());
}

TEST(FineHeights, LinesAlongThePathTellNothing) {
  for (const double contrast : {3, 10, 40})
    for (const double width : {0.1, 0.3, 0.8}) {
      const auto lines = [&](double, double y) {
        return 120 + contrast * (std::fmod(y, 3 * width) < width);
      };
      EXPECT_LT(Measure(LookAt(Kerb, lines)).size(), 30) << contrast << " " << width;
    }
}

}  // namespace
}  // namespace parkade

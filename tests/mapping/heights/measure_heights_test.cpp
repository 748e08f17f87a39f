#include "mapping/heights/measure_heights.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "core/error.h"
#include "mapping/baselines/fuse_voxels.h"

namespace parkade {
namespace {

constexpr double kEyeHeight = 1.0;  // [m]

/// Gray values of a ground that shows something everywhere; `contrast` 0: nothing.
double TextureAt(double x, double y, double contrast) {
  return 120 +
         contrast * (std::sin(7 * x + 3 * y) + std::sin(4 * x - 9 * y) + std::sin(11 * x + 8 * y));
}

/// What cameras above (x, 0) see of a level ground at `height`, put onto the plane z = 0 on which
/// their car stands. \param shade  gray values of a shade that goes along with the car
std::vector<PosedGroundPatch> LookAt(double height, double contrast, double shade = 0) {
  std::vector<PosedGroundPatch> patches;
  for (double x = 0; x <= 12; x += 0.5) {
    PosedGroundPatch posed{{.drive = 0, .camera = 0, .time = {}, .samples = {}}, {}};
    posed.site_from_body.translation.x() = x;
    for (double gx = x - 5; gx <= x + 5; gx += 0.09)
      for (double gy = 1.5; gy <= 6; gy += 0.09) {
        const double stretch = kEyeHeight / (kEyeHeight - height);
        const auto gray = static_cast<std::uint8_t>(
            std::lround(TextureAt(gx, gy, contrast) + shade * std::sin(0.9 * (gx - x) + 0.7 * gy)));
        GroundSample sample;
        sample.point_in_body =
            Eigen::Vector3f(Eigen::Vector3d(stretch * (gx - x), stretch * gy, 0).cast<float>());
        sample.blue = sample.green = sample.red = gray;
        sample.is_free = true;
        posed.patch.samples.push_back(sample);
      }
    patches.push_back(std::move(posed));
  }
  return patches;
}

DrivenPath PathWithEye() {
  DrivenPath path;
  path.cameras_in_body.emplace_back(0, 0, kEyeHeight);
  return path;
}

HeightField LevelField() {
  std::vector<HeightObservation> heights;
  for (double x = -8; x < 20; x += 0.4)
    for (double y = -2; y < 10; y += 0.4) heights.push_back({{x, y, 0}, 100});
  return HeightField(heights, {});
}

std::vector<HeightObservation> Measure(double height, double contrast) {
  const std::vector<PosedGroundPatch> patches = LookAt(height, contrast);
  const DrivenPath path = PathWithEye();
  return MeasureHeights(PatchesInMemory(patches), std::span(&path, 1), LevelField(), 0.15, {});
}

TEST(MeasureHeights, FindsTheHeightAtWhichViewsAgree) {
  for (const double height : {0.06, -0.08}) {
    const std::vector<HeightObservation> heights = Measure(height, 20);
    ASSERT_GT(heights.size(), 100u);
    double sum = 0;
    for (const HeightObservation& found : heights) {
      const double error = found.point_in_site.z() - height;
      EXPECT_LT(std::abs(error), 0.03) << "at the rim of what is seen, where few views meet";
      sum += error * error;
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(heights.size())), 0.01);
  }
}

/// [m] RMS error where a car came by so many times.
double ErrorAfter(size_t num_passes, size_t& num_patches) {
  std::vector<PosedGroundPatch> patches;
  for (size_t pass = 0; pass < num_passes; ++pass)
    for (PosedGroundPatch& posed : LookAt(0.06, 20)) {
      std::vector<GroundSample> few;
      for (size_t i = pass % 4; i < posed.patch.samples.size(); i += 4)
        few.push_back(posed.patch.samples[i]);
      posed.patch.samples = std::move(few);
      patches.push_back(std::move(posed));
    }
  num_patches = patches.size();
  const DrivenPath path = PathWithEye();
  double sum = 0;
  int count = 0;
  for (const HeightObservation& found :
       MeasureHeights(PatchesInMemory(patches), std::span(&path, 1), LevelField(), 0.15, {})) {
    sum += std::pow(found.point_in_site.z() - 0.06, 2);
    ++count;
  }
  EXPECT_GT(count, 100);
  return std::sqrt(sum / count);
}

TEST(MeasureHeights, WhereACarCameByOftenTilesAreSweptOneByOneAndFindTheSame) {
  size_t num_patches = 0;
  const double together = ErrorAfter(12, num_patches);
  ASSERT_LE(num_patches, 300u) << "in a block";
  const double one_by_one = ErrorAfter(16, num_patches);
  ASSERT_GT(num_patches, 300u);

  EXPECT_LT(one_by_one, 0.015);
  EXPECT_NEAR(one_by_one, together, 0.001);
}

/// Counts how often patches are read.
class CountingSource final : public PatchSource {
 public:
  explicit CountingSource(const PatchSource& source) : source_(&source) {
    views_.assign(source.views().begin(), source.views().end());
  }
  PosedGroundPatch Read(std::size_t index) const override {
    return ++num_reads_, source_->Read(index);
  }
  int num_reads() const { return num_reads_; }

 private:
  const PatchSource* source_;
  mutable std::atomic<int> num_reads_ = 0;
};

TEST(MeasureHeights, OfManyViewsASelectionFindsTheSame) {
  std::vector<PosedGroundPatch> patches;
  for (int pass = 0; pass < 6; ++pass)
    for (PosedGroundPatch& posed : LookAt(0.06, 20)) patches.push_back(std::move(posed));
  const PatchesInMemory source(patches);
  const CountingSource all(source), selection(source);
  const DrivenPath path = PathWithEye();

  const auto by_all = MeasureHeights(all, std::span(&path, 1), LevelField(), 0.15, {});
  const auto by_selection =
      MeasureHeights(selection, std::span(&path, 1), LevelField(), 0.15, {.max_views = 20});

  EXPECT_GE(all.num_reads(), 150) << "each patch reaches into a tile";
  EXPECT_LT(selection.num_reads(), all.num_reads() / 2);
  ASSERT_GT(by_selection.size(), 0.9 * static_cast<double>(by_all.size()));
  double sum = 0;
  for (const HeightObservation& found : by_selection)
    sum += std::pow(found.point_in_site.z() - 0.06, 2);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(by_selection.size())), 0.015);
}

TEST(MeasureHeights, ShadesThatGoAlongWithTheCarDoNotHoldTheSurfaceWhereItIs) {
  const std::vector<PosedGroundPatch> patches = LookAt(0.06, 4, 30);
  const DrivenPath path = PathWithEye();
  const std::vector<HeightObservation> heights =
      MeasureHeights(PatchesInMemory(patches), std::span(&path, 1), LevelField(), 0.15, {});

  ASSERT_GT(heights.size(), 100u);
  size_t num_held = 0;
  double sum = 0;
  for (const HeightObservation& found : heights) {
    num_held += std::abs(found.point_in_site.z()) < 0.02;
    sum += std::pow(found.point_in_site.z() - 0.06, 2);
  }
  EXPECT_EQ(num_held, 0u);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(heights.size())), 0.015);
}

TEST(MeasureHeights, GroundThatShowsNothingGetsNoHeight) { EXPECT_TRUE(Measure(0.06, 0).empty()); }

TEST(MeasureHeights, NothingInNothingOut) {
  EXPECT_TRUE(MeasureHeights(PatchesInMemory({}), {}, LevelField(), 0.15, {}).empty());
}

TEST(MeasureHeights, RejectsASweepWithoutSteps) {
  MeasureHeightsOptions options;
  options.num_steps = 0;
  EXPECT_THROW(options.Validate(), Error);
}

TEST(FuseVoxels, TheSurfaceLiesOnThePlaneOfTheCar) {
  const std::vector<PosedGroundPatch> patches = LookAt(0.06, 20);
  const DrivenPath path = PathWithEye();

  const SurfaceMap surface = FuseVoxels(PatchesInMemory(patches), std::span(&path, 1), 0.05);

  ASSERT_GT(surface.cells.size(), 1000u);
  for (const SurfaceCell& cell : surface.cells) {
    EXPECT_NEAR(cell.height, 0, 0.05) << "to half a voxel, whatever the ground is really like";
    EXPECT_GT(cell.free_belief, 0.5F);
  }
}

TEST(FuseVoxels, RejectsVoxelsThatCellsDoNotFill) {
  EXPECT_THROW(FuseVoxels(PatchesInMemory({}), {}, 0.03), Error);
}

}  // namespace
}  // namespace parkade

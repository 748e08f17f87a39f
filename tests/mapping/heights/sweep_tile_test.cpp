#include "mapping/heights/sweep_tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "core/parallel.h"

namespace parkade {
namespace {

SweepShape SmallShape() {
  return {.num_windows = 3,
          .cells_per_window = 4,
          .cell_size = 0.1F,
          .offsets = {-0.1F, -0.03F, 0, 0.05F, 0.1F}};
}

std::vector<Meeting> RandomMeetings(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-0.4F, 1.6F), shift(-6, 6), gray(-40, 40),
      weight(0.1F, 1);
  std::vector<Meeting> observations;
  for (int i = 0; i < count; ++i)
    observations.push_back({{place(random), place(random)},
                            {shift(random), shift(random)},
                            gray(random),
                            weight(random)});
  return observations;
}

/// One view's mean of a cell.
struct Mean {
  float weight = 0, sum = 0;
  float gray() const { return sum / weight; }
};

/// By the book: sorted into cells and views one by one, height by height.
std::vector<Agreement> SweepSlowly(const std::vector<std::vector<Meeting>>& views,
                                   const SweepShape& shape) {
  const int across = shape.num_windows * shape.cells_per_window;
  std::vector<Agreement> agreements;
  for (int window = 0; window < shape.num_windows * shape.num_windows; ++window)
    for (const float offset : shape.offsets) {
      std::map<std::pair<int, int>, std::map<size_t, Mean>> cells;
      for (size_t view = 0; view < views.size(); ++view)
        for (const Meeting& observation : views[view]) {
          const Eigen::Vector2f place =
              (observation.point + offset * observation.shift) / shape.cell_size;
          const int x = static_cast<int>(std::floor(place.x())),
                    y = static_cast<int>(std::floor(place.y()));
          if (x < 0 || y < 0 || x >= across || y >= across) continue;
          if (y / shape.cells_per_window * shape.num_windows + x / shape.cells_per_window != window)
            continue;
          Mean& mean = cells[{y, x}][view];
          mean.weight += observation.weight;
          mean.sum += observation.weight * observation.gray;
        }
      Agreement agreement;
      for (const auto& [place, means] : cells) {
        Mean cell;
        for (const auto& [view, mean] : means) cell.weight += mean.weight, cell.sum += mean.sum;
        for (const auto& [view, mean] : means) {
          const float off = mean.gray() - cell.gray();
          agreement.residual += mean.weight * off * off;
          agreement.total += mean.weight * mean.gray() * mean.gray();
        }
        agreement.weight += cell.weight;
        agreement.num_samples += static_cast<int>(means.size());
        ++agreement.num_cells;
      }
      agreements.push_back(agreement);
    }
  return agreements;
}

/// As views of equally many.
std::vector<std::vector<Meeting>> InViews(const std::vector<Meeting>& observations, size_t count) {
  std::vector<std::vector<Meeting>> views(count);
  for (size_t i = 0; i < observations.size(); ++i)
    views[i * count / observations.size()].push_back(observations[i]);
  return views;
}

TileSweep SweepOf(const std::vector<std::vector<Meeting>>& views,
                  const SweepShape& shape = SmallShape()) {
  TileSweep sweep(shape);
  for (const std::vector<Meeting>& view : views) {
    sweep.BeginView();
    for (const Meeting& observation : view) sweep.Add(observation);
  }
  return sweep;
}

void ExpectAlike(const std::vector<Agreement>& fast, const std::vector<Agreement>& slow) {
  ASSERT_EQ(fast.size(), slow.size());
  for (size_t i = 0; i < slow.size(); ++i) {
    ASSERT_GT(slow[i].num_samples, 40);
    // An observation on the border of a cell may fall to either side.
    EXPECT_NEAR(fast[i].num_samples, slow[i].num_samples, 2) << i;
    EXPECT_NEAR(fast[i].num_cells, slow[i].num_cells, 1) << i;
    EXPECT_NEAR(fast[i].total, slow[i].total, 0.02F * slow[i].total) << i;
    EXPECT_NEAR(fast[i].residual, slow[i].residual, 0.03F * slow[i].total) << i;
    EXPECT_NEAR(fast[i].Misfit(), slow[i].Misfit(), 0.04) << i;
  }
}

TEST(TileSweep, SumsUpWhatASimpleOneDoes) {
  const auto views = InViews(RandomMeetings(6000), 12);
  std::vector<Agreement> coarse;
  const std::vector<Agreement> fine = SweepOf(views).SweepTwice(&coarse);

  ExpectAlike(fine, SweepSlowly(views, SmallShape()));
  SweepShape of_coarse = SmallShape();
  of_coarse.cell_size *= 2, of_coarse.cells_per_window /= 2;
  ExpectAlike(coarse, SweepSlowly(views, of_coarse));
}

TEST(TileSweep, OneViewAgreesWithItself) {
  for (const Agreement& agreement : SweepOf({RandomMeetings(500)}).Sweep()) {
    EXPECT_NEAR(agreement.residual, 0, 1e-3F * agreement.total);
    EXPECT_EQ(agreement.num_samples, agreement.num_cells);
    EXPECT_EQ(agreement.Misfit(), 1) << "which tells nothing";
  }
}

TEST(TileSweep, ObservationsFromOneSideHaveNoParallax) {
  TileSweep from_one_side(SmallShape()), from_two(SmallShape());
  from_one_side.BeginView(), from_two.BeginView();
  for (Meeting observation : RandomMeetings(500)) {
    observation.shift = {3, 1};
    from_one_side.Add(observation);
    from_two.Add(observation);
    observation.shift = {-1, -2};
    from_two.Add(observation);
  }

  ASSERT_EQ(from_two.Parallaxes().size(), 9u);
  for (const float parallax : from_one_side.Parallaxes()) EXPECT_NEAR(parallax, 0, 0.02F);
  for (const float parallax : from_two.Parallaxes())
    EXPECT_NEAR(parallax, 2.5F, 0.02F) << "half of (4, 3)";
}

TEST(TileSweep, DoesNotDependOnTheNumberOfThreads) {
  const TileSweep sweep = SweepOf(InViews(RandomMeetings(3000), 10));
  const int before = NumThreads();

  SetNumThreads(1);
  const std::vector<Agreement> alone = sweep.Sweep();
  SetNumThreads(3);
  const std::vector<Agreement> together = sweep.Sweep();
  SetNumThreads(before);

  ASSERT_EQ(alone.size(), together.size());
  for (size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i].residual, together[i].residual);
    EXPECT_EQ(alone[i].num_samples, together[i].num_samples);
  }
}

TEST(TileSweep, AgreesBestWhereRaysMeet) {
  std::vector<std::vector<Meeting>> views(6);
  for (int i = 0; i < 144; ++i) {  // one spot per cell, seen from six sides, 0.05 m above
    const Eigen::Vector2f spot(0.1F * static_cast<float>(i % 12) + 0.05F,
                               0.1F * static_cast<float>(i / 12) + 0.05F);
    const auto gray = static_cast<float>(i * 37 % 41 - 20);
    for (int view = 0; view < 6; ++view) {
      const Eigen::Vector2f shift = 4 * Eigen::Vector2f(std::cos(static_cast<float>(view)),
                                                        std::sin(static_cast<float>(view)));
      views[static_cast<size_t>(view)].push_back({spot - 0.05F * shift, shift, gray, 1});
    }
  }

  const std::vector<Agreement> agreements = SweepOf(views).Sweep();

  for (size_t window = 0; window < 9; ++window) {
    EXPECT_NEAR(agreements[5 * window + 3].Misfit(), 0, 1e-4);
    for (const size_t height : {0, 1, 2, 4})
      EXPECT_GT(agreements[5 * window + height].Misfit(), 0.3) << height;
  }
}

}  // namespace
}  // namespace parkade

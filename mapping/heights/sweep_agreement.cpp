#include "mapping/heights/sweep_agreement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/statistics.h"

namespace parkade {

void Agreement::Add(const Agreement& other) {
  residual += other.residual;
  total += other.total;
  weight += other.weight;
  num_samples += other.num_samples;
  num_cells += other.num_cells;
  num_means += other.num_means;
}

double Agreement::Misfit() const {
  const double freedom = num_samples - num_cells;
  if (!(freedom > 0 && total > 0)) return 1;
  return static_cast<double>(residual) / static_cast<double>(total) * (num_samples - num_means) /
         freedom;
}

std::vector<double> MisfitsOf(std::span<const Agreement> agreements, double noise,
                              double min_freedom) {
  const std::size_t count = agreements.size();
  std::vector<double> differences(count), above(count), misfits(count, 1);
  const auto freedom = [&](std::size_t i) {
    return agreements[i].num_samples - agreements[i].num_cells;
  };
  const auto mean = [&](float sum, std::size_t i) {
    return static_cast<double>(sum / std::max(1.0F, agreements[i].weight));
  };
  for (std::size_t i = 0; i < count; ++i)
    if (freedom(i) > 0 && freedom(i) >= min_freedom)
      differences[i] = mean(agreements[i].residual, i) * agreements[i].num_samples / freedom(i);
  for (std::size_t i = count; i-- > 1;) above[i - 1] = std::max(above[i], differences[i]);
  double below = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double wrong = std::min({mean(agreements[i].total, i), below, above[i]}) + noise,
                 here = differences[i] + noise;
    if (freedom(i) > 0 && freedom(i) >= min_freedom && here < wrong) misfits[i] = here / wrong;
    below = std::max(below, differences[i]);
  }
  return misfits;
}

bool IsSeenWell(const Agreement& agreement, const SweepDemands& demands) {
  if (agreement.num_samples < demands.samples_per_cell * agreement.num_cells ||
      agreement.num_cells < demands.num_cells)
    return false;
  const double contrast =
      std::sqrt(static_cast<double>(agreement.total / std::max(agreement.weight, 1e-6F)));
  return contrast >= demands.contrast;
}

bool IsClear(const std::vector<double>& misfits, std::size_t best, const SweepClarity& clarity) {
  if (misfits[best] > clarity.max_misfit * Median(misfits)) return false;
  const auto rival_steps = static_cast<std::size_t>(clarity.rival_steps);
  for (std::size_t i = 1; i + 1 < misfits.size(); ++i) {
    const bool is_elsewhere = i + rival_steps <= best || best + rival_steps <= i;
    const bool is_dip = misfits[i] <= misfits[i - 1] && misfits[i] <= misfits[i + 1];
    if (is_elsewhere && is_dip && misfits[best] > clarity.max_rivalry * misfits[i]) return false;
  }
  return true;
}

std::optional<SweepMinimum> FitMinimum(std::span<const double> misfits, std::size_t best,
                                       double step, int freedom) {
  const double before = misfits[best - 1], here = misfits[best], after = misfits[best + 1];
  const double curvature = before - 2 * here + after;
  if (curvature <= 0) return std::nullopt;
  // Misfit is a mean of squares: its noise is misfit / freedom, its second derivative curvature /
  // step^2.
  return SweepMinimum{0.5 * step * (before - after) / curvature,
                      kViewCorrelation * 2 * here * step * step / (curvature * freedom)};
}

double FreedomOf(std::span<const Agreement> agreements) {
  std::vector<double> freedoms;
  freedoms.reserve(agreements.size());
  for (const Agreement& at : agreements) freedoms.push_back(at.num_samples - at.num_cells);
  return Median(std::move(freedoms));
}

std::vector<float> CostsOf(std::span<const Agreement> agreements, double max_freedom) {
  constexpr double kMinFreedom = 12;
  constexpr double kLeastMisfit = 0.05;  // lower ones say no more
  constexpr double kNoise = 1.0;         // [gray values] that views differ by for other reasons
  std::vector<float> costs(agreements.size());
  const double usual = FreedomOf(agreements);
  if (usual < kMinFreedom) return costs;
  const double freedom = std::min(usual / kViewCorrelation, max_freedom);
  const std::vector<double> misfits = MisfitsOf(agreements, kNoise * kNoise, 0.5 * usual);
  for (std::size_t i = 0; i < costs.size(); ++i)
    costs[i] = static_cast<float>(0.5 * freedom * std::log(std::max(misfits[i], kLeastMisfit)));
  return costs;
}

}  // namespace parkade

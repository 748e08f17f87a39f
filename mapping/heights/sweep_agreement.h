#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace parkade {

/// How well views agree over a piece of ground at one height of a sweep.
struct Agreement {
  float residual = 0,
        total = 0;  ///< of squared gray values: within cells, and altogether
  float weight = 0;
  int num_samples = 0;  ///< that are compared: means of what one view saw of a cell
  int num_cells = 0;
  int num_means = 0;  ///< that were taken off before `total` was summed up

  void Add(const Agreement& other);

  /// Share of the variance that remains within cells: 1 where heights do not matter.
  double Misfit() const;
};

/// How much views differ at each height of a sweep, as a share of how much they would if it were
/// wrong: of what they show there, but of no more than they differ by anywhere below it, nor above.
/// What looks alike at all heights, as lines along the path do, tells none of them. 1 where nothing
/// is told, and where `freedom`, samples less cells, is less than is asked for.
/// \param noise  [gray values squared] by which views differ at the right height
std::vector<double> MisfitsOf(std::span<const Agreement> agreements, double noise,
                              double min_freedom);

/// What ground must show for a sweep over it to be judged.
struct SweepDemands {
  double samples_per_cell = 0;
  double num_cells = 0;
  double contrast = 0;  ///< [gray values] rms
};

/// Whether that much is seen at one height.
bool IsSeenWell(const Agreement& agreement, const SweepDemands& demands);

/// How far the least misfit of a sweep must lie below the others.
struct SweepClarity {
  double max_misfit = 1;   ///< of the median over all heights
  double max_rivalry = 1;  ///< of another dip of the misfit
  int rival_steps = 3;     ///< of the sweep from the least misfit to what counts as another dip
};

/// Whether views agree at height `best` better than at most others, and nowhere else as well.
bool IsClear(const std::vector<double>& misfits, std::size_t best, const SweepClarity& clarity);

/// Where between two heights of a sweep views agree best.
struct SweepMinimum {
  double offset = 0;    ///< [m] from the height of least misfit
  double variance = 0;  ///< [m^2]
};

/// The lowest point of a parabola through the misfits at `best`, which is neither the first nor the
/// last, and beside it; nothing where these do not curve. \param step  [m] of the sweep
/// \param freedom  samples that tell independently of each other but for their view
std::optional<SweepMinimum> FitMinimum(std::span<const double> misfits, std::size_t best,
                                       double step, int freedom);

/// By how much samples of one view, which are not independent, raise variances.
inline constexpr double kViewCorrelation = 4.0;

/// Samples less the cells' means that they gave, usually.
double FreedomOf(std::span<const Agreement> agreements);

/// [nats] what a sweep says against each height: the logarithm of a variance is distributed as if
/// it had been estimated from the samples that are not spent on the cells' means, `max_freedom` of
/// them at most. All 0 where too little is seen.
std::vector<float> CostsOf(std::span<const Agreement> agreements, double max_freedom);

}  // namespace parkade

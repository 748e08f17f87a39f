#include "mapping/kerbs/kerb_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/heights/scanline_costs.h"
#include "mapping/heights/sweep_agreement.h"
#include "mapping/kerbs/kerb_sweep.h"

namespace parkade {
namespace {

constexpr StripWindow kBeyond{
    0.05, -0.06, KerbStep::kMaxHeight};             // what lies nearer may be the front of the step
constexpr StripWindow kBefore{-0.65, -0.08, 0.08};  // the rim may be of something else
constexpr double kMinParallax = 1.0;  // [m per meter of height] views from one side agree anywhere
constexpr double kMinFreedom = 12;    // of samples less cells: fewer say nothing
constexpr double kMaxFreedom = 4;     // samples of a strip err together, strips along it do not
constexpr double kNoise = 9;          // [gray values squared] by which views differ anyway
constexpr double kLeastMisfit = 0.05;
constexpr float kMinEvidence = 0.05F;  // [nats] of a strip itself
constexpr double kMaxSigma = 0.015;    // [m]
constexpr StepPenalties kAlongKerbs{1.2F, 5};
constexpr auto kUsual = static_cast<float>(KerbStep::kUsual),
               kUsualSigma = static_cast<float>(KerbStep::kUsualSigma);
constexpr int kMaxChainGap = 3;  // strips from one to the next of a chain
constexpr double kSeenShare =
    0.5;  // of the samples at the height that has most: with fewer none is judged
constexpr double kMinObservations = 6;  // of a cell on average: less agrees by chance
constexpr double kMinCells = 0.5;       // of those of a strip and those beside it
constexpr double kMinContrast = 1.5;    // [gray values] rms
constexpr int kRivalSteps = 4;   // of the sweep from the best height to what may be another one
constexpr int kMinHeights = 10;  // of a sweep
constexpr double kFarDip =
    0.8;  // of the misfit farther off at the best height, of that below it ...
constexpr double kFarRise = 0.9;  // ... and above it
constexpr double kFarBelow = 0.04,
                 kFarAbove = 0.02;  // [m] it may lie below or above what is next to the outline
constexpr double kUnknownGround = 0.01;  // [m] of the ground at the outline where it was not swept
constexpr int kMinViews = 5;             // of a strip

/// What several strips say together.
std::vector<Agreement> SumOf(std::span<const std::size_t> indices,
                             std::span<const SweptStrip> swept, bool is_near, bool is_far) {
  std::vector<Agreement> sums;
  for (const std::size_t i : indices)
    for (const auto* part :
         {is_near ? &swept[i].near_outline : nullptr, is_far ? &swept[i].far_off : nullptr}) {
      if (part == nullptr || part->empty()) continue;
      sums.resize(part->size());
      for (std::size_t k = 0; k < part->size(); ++k) sums[k].Add((*part)[k]);
    }
  return sums;
}

/// Misfits at those heights of a sweep at which enough is seen.
struct Misfits {
  std::size_t first = 0;  ///< step of the sweep that the first is of
  std::vector<double> values = {};
};

Misfits MisfitsOf(const std::vector<Agreement>& agreements) {
  if (agreements.empty()) return {};
  const auto most =
      std::max_element(agreements.begin(), agreements.end(),
                       [](const auto& a, const auto& b) { return a.num_samples < b.num_samples; });
  const auto is_seen = [&](const Agreement& at) {
    return at.num_samples > 0 && at.num_samples >= kSeenShare * most->num_samples;
  };
  auto begin = most, end = most;
  while (begin != agreements.begin() && is_seen(*(begin - 1))) --begin;
  while (end != agreements.end() && is_seen(*end)) ++end;
  Misfits misfits{static_cast<std::size_t>(begin - agreements.begin())};
  for (auto at = begin; at != end; ++at) misfits.values.push_back(at->Misfit());
  return misfits;
}

/// The share of the variance along the rows that remains within cells.
double ShareWithin(const Agreement& at) {
  const double weight = std::max(1.0F, at.weight);
  const double within = static_cast<double>(at.residual) / weight / (at.num_samples - at.num_cells),
               along = static_cast<double>(at.total) / weight / (at.num_samples - at.num_means);
  const double noise = kNoise / at.num_samples;
  return std::clamp((within + noise) / (along + noise), kLeastMisfit, 1.0);
}

/// [nats] what a strip says against each height; all 0 where it says nothing. Each height is judged
/// by what varies there: once the kerb has left the window little does, whatever the height.
std::vector<float> CostsOf(const SweptStrip& swept) {
  std::vector<float> costs(static_cast<std::size_t>(kBeyond.NumHeights()));
  if (swept.num_views < kMinViews || swept.parallax < kMinParallax || swept.near_outline.empty())
    return costs;
  std::vector<Agreement> agreements = swept.near_outline;
  for (std::size_t i = 0; i < agreements.size(); ++i) agreements[i].Add(swept.far_off[i]);
  const double usual = FreedomOf(agreements);
  if (usual < kMinFreedom) return costs;
  const double freedom = std::min(usual / kViewCorrelation, kMaxFreedom);
  for (std::size_t i = 0; i < costs.size(); ++i)
    if (agreements[i].num_samples - agreements[i].num_cells >= 0.5 * usual)
      costs[i] = static_cast<float>(0.5 * freedom * std::log(ShareWithin(agreements[i])));
  return costs;
}

/// The strip before each one along its outline, or -1.
std::vector<int> FindBefore(std::span<const OutlineStrip> strips) {
  std::vector<int> before(strips.size(), -1);
  for (std::size_t i = 1; i < strips.size(); ++i)
    if (strips[i].ring == strips[i - 1].ring &&
        strips[i].index - strips[i - 1].index <= kMaxChainGap)
      before[i] = static_cast<int>(i) - 1;
  return before;
}

/// What is said of the heights of what lies beyond each strip, with those along it and alone.
struct HeightCosts {
  std::vector<float> heights;      ///< [m] above the ground at the outline
  std::vector<float> own, summed;  ///< [nats] strips x heights

  std::span<const float> Of(const std::vector<float>& costs, std::size_t strip) const {
    return std::span(costs).subspan(strip * heights.size(), heights.size());
  }
};

HeightCosts CostsOf(std::span<const OutlineStrip> strips, std::span<const SweptStrip> beyond) {
  HeightCosts costs;
  for (int i = 0; i < kBeyond.NumHeights(); ++i)
    costs.heights.push_back(static_cast<float>(kBeyond.HeightAt(i)));
  for (const SweptStrip& swept : beyond) {
    const std::vector<float> of_strip = CostsOf(swept);
    costs.own.insert(costs.own.end(), of_strip.begin(), of_strip.end());
  }
  costs.summed = SumAlongChains(FindBefore(strips), costs.own, costs.heights.size(), kAlongKerbs);
  SubtractLeast(costs.summed, costs.heights.size());
  return costs;
}

/// The height that views agree on, if they do.
std::optional<KerbStep> MeasuredTop(const HeightCosts& costs, std::size_t strip) {
  const HeightBelief belief = BeliefOf(costs.Of(costs.summed, strip), costs.heights);
  if (belief.sigma > kMaxSigma || EvidenceOf(costs.Of(costs.own, strip)) < kMinEvidence) return {};
  return KerbStep{belief.mean, belief.sigma};
}

/// What is known of the height of a kerb, if only how high kerbs are.
KerbStep TopOfKerb(const HeightCosts& costs, std::size_t strip) {
  std::vector<float> with_prior;
  for (std::size_t i = 0; i < costs.heights.size(); ++i) {
    const float off = (costs.heights[i] - kUsual) / kUsualSigma;
    with_prior.push_back(costs.Of(costs.summed, strip)[i] + 0.5F * off * off);
  }
  const HeightBelief belief = BeliefOf(with_prior, costs.heights);
  return {belief.mean, belief.sigma};
}

/// How clear a dip of the misfit must be. \see SweepClarity
struct Clarity {
  double max_misfit = 0, max_rivalry = 0;
  double max_side = 0;  ///< of the greatest misfit below it, and of that above
};

/// The height at which views agree, unless they do nowhere, or as well elsewhere. `num_cells` are
/// all there are.
std::optional<KerbStep> FindStep(const std::vector<Agreement>& agreements,
                                 const StripWindow& window, double num_cells,
                                 const Clarity& clarity) {
  const auto [first, misfits] = MisfitsOf(agreements);
  if (misfits.size() < kMinHeights) return {};
  const auto lowest = std::min_element(misfits.begin(), misfits.end());
  const auto best = static_cast<std::size_t>(lowest - misfits.begin());
  if (best < 2 || best + 3 > misfits.size()) return {};
  const Agreement& at = agreements[first + best];
  if (!IsSeenWell(at, {kMinObservations, kMinCells * num_cells, kMinContrast}) ||
      !IsClear(misfits, best, {clarity.max_misfit, clarity.max_rivalry, kRivalSteps}))
    return {};
  const double below = *std::max_element(misfits.begin(), lowest),
               above = *std::max_element(lowest + 1, misfits.end());
  if (*lowest > clarity.max_side * std::min(below, above)) return {};
  const std::optional<SweepMinimum> minimum =
      FitMinimum(misfits, best, StripWindow::kHeightStep, at.num_samples);
  if (!minimum) return {};
  return KerbStep{window.HeightAt(static_cast<double>(first + best)) + minimum->offset,
                  std::sqrt(minimum->variance)};
}

/// The ground before the outline [m] above what the map says: its height is nearly known.
std::optional<KerbStep> GroundBefore(const std::vector<Agreement>& agreements) {
  constexpr Clarity kFaint{0.97, 0.98, 0.95};
  constexpr double kCellsPerStrip = (StripWindow::kNearRows + StripWindow::kFarRows) *
                                    KerbStep::kStripLength / StripWindow::kCellSize;
  return FindStep(agreements, kBefore, kCellsPerStrip * (2 * KerbStep::kReach + 1), kFaint);
}

/// Whether what lies farther off is as high: then the step has a level top.
bool IsLevel(const std::vector<Agreement>& far_off, double height) {
  const Misfits seen = MisfitsOf(far_off);
  const std::vector<double>& misfits = seen.values;
  const auto step_at = [&](double at) {
    const double step =
        (at - kBeyond.HeightAt(static_cast<double>(seen.first))) / StripWindow::kHeightStep;
    return std::clamp(static_cast<std::ptrdiff_t>(std::lround(step)), std::ptrdiff_t{1},
                      static_cast<std::ptrdiff_t>(misfits.size()) - 2);
  };
  if (misfits.size() < kMinHeights) return false;
  const auto begin = misfits.begin() + step_at(height - kFarBelow),
             end = misfits.begin() + step_at(height + kFarAbove);
  const auto best = std::min_element(begin, end + 1);
  return *best <= kFarDip * *std::max_element(misfits.begin(), best) &&
         *best <= kFarRise * *std::max_element(best + 1, misfits.end());
}

}  // namespace

bool Agree(const KerbStep& a, const KerbStep& b) {
  constexpr double kMaxJump = 0.03;  // [m] along one kerb
  return std::abs(a.height - b.height) <= std::max(kMaxJump, a.sigma + b.sigma);
}

std::vector<std::size_t> Around(const OutlineStrip& strip, const StripsAlong& along, int reach) {
  std::vector<std::size_t> around;
  for (int i = -reach; i <= reach; ++i) {
    const int index = ((strip.index + i) % strip.ring_size + strip.ring_size) % strip.ring_size;
    const auto found = along.find({strip.ring, index});
    if (found != along.end() &&
        std::find(around.begin(), around.end(), found->second) == around.end())
      around.push_back(found->second);
  }
  return around;
}

std::vector<std::optional<KerbStep>> MeasureSteps(std::span<const OutlineStrip> strips,
                                                  std::span<const KerbLook> looks,
                                                  const StripsAlong& along, double min_height,
                                                  const PatchSource& patches,
                                                  std::span<const DrivenPath> paths) {
  const std::array<StripWindow, 2> windows = {kBeyond, kBefore};
  const auto swept = SweepStrips(strips, KerbStep::kStripLength, patches, paths, windows);
  const std::vector<SweptStrip>&beyond = swept[0], &before = swept[1];
  const HeightCosts costs = CostsOf(strips, beyond);
  std::vector<std::optional<KerbStep>> steps(strips.size());
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const std::vector<std::size_t> around = Around(strips[i], along, KerbStep::kReach);
    std::optional<KerbStep> top = MeasuredTop(costs, i);
    const bool is_flat = top && top->height < min_height - 2 * top->sigma;
    const bool is_front = top && !IsLevel(SumOf(around, beyond, false, true), top->height);
    if (is_front) top.reset();
    const bool is_near = beyond[i].num_views >= kMinViews;
    if (looks[i] == KerbLook::kKerb && is_near && !is_flat)
      top = is_front ? KerbStep{KerbStep::kUsual, KerbStep::kUsualSigma} : TopOfKerb(costs, i);
    if (!top) continue;
    const std::optional<KerbStep> ground = GroundBefore(SumOf(around, before, true, true));
    if (ground) top->height -= ground->height;
    const double ground_sigma =
        ground ? ground->sigma : std::max(kUnknownGround, strips[i].height_sigma);
    top->sigma = std::hypot(top->sigma, ground_sigma, KerbStep::kLeastSigma);
    steps[i] = top;
  }
  return steps;
}

}  // namespace parkade

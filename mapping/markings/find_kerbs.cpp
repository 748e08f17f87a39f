#include "mapping/markings/find_kerbs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/error.h"
#include "mapping/markings/kerb_sweep.h"
#include "mapping/markings/outline_strips.h"

namespace parkade {
namespace {

constexpr double kStripLength = 1.0;  // [m]
constexpr int kReach = 1;             // strips to each side that are asked together with one
constexpr int kSupportReach = 3;      // strips to each side that may support one ...
constexpr int kMinSupport = 2;        // ... and so many must
constexpr int kMaxGap = 3;            // strips from one to the next of the same kerb
constexpr StripWindow kBeyond{0.05, -0.06, 0.34};   // what lies nearer may be the front of the step
constexpr StripWindow kBefore{-0.65, -0.08, 0.08};  // the rim may be of something else
constexpr double kSeenShare =
    0.5;  // of the samples at the height that has most: with fewer none is judged
constexpr double kMinObservations = 6;  // of a cell on average: less agrees by chance
constexpr double kMinCells = 0.5;       // of those of a strip and those beside it
constexpr double kMinContrast = 1.5;    // [gray values] rms
constexpr int kRivalSteps = 4;      // of the sweep from the best height to what may be another one
constexpr int kMinHeights = 10;     // of a sweep
constexpr double kCorrelation = 4;  // samples of one view are not independent: variances times this
constexpr double kFarDip =
    0.8;  // of the misfit farther off at the best height, of that below it ...
constexpr double kFarRise = 0.9;  // ... and above it
constexpr double kFarBelow = 0.04,
                 kFarAbove = 0.02;  // [m] it may lie below or above what is next to the outline
constexpr double kUnknownGround = 0.01;  // [m] of the ground at the outline where it was not swept
constexpr double kSigma = 0.005;         // [m] at best

/// A height of a sweep at which views agree.
struct Dip {
  double height = 0, sigma = 0;  ///< [m]
};

/// How clear a dip must be.
struct Clarity {
  double max_misfit = 0, max_rivalry = 0, max_side = 0;
};

/// Strips by place along their outline.
using StripsAlong = std::map<std::pair<int, int>, std::size_t>;

/// The strips up to `reach` to each side of one, and itself.
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

/// What several strips say together.
std::vector<StripAgreement> SumOf(std::span<const std::size_t> indices,
                                  std::span<const SweptStrip> swept, bool is_near, bool is_far) {
  std::vector<StripAgreement> sums;
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

Misfits MisfitsOf(const std::vector<StripAgreement>& agreements) {
  if (agreements.empty()) return {};
  const auto most =
      std::max_element(agreements.begin(), agreements.end(),
                       [](const auto& a, const auto& b) { return a.num_samples < b.num_samples; });
  const auto is_seen = [&](const StripAgreement& at) {
    return at.num_samples > 0 && at.num_samples >= kSeenShare * most->num_samples;
  };
  auto begin = most, end = most;
  while (begin != agreements.begin() && is_seen(*(begin - 1))) --begin;
  while (end != agreements.end() && is_seen(*end)) ++end;
  Misfits misfits{static_cast<std::size_t>(begin - agreements.begin())};
  for (auto at = begin; at != end; ++at) misfits.values.push_back(at->Misfit());
  return misfits;
}

bool HasRival(const std::vector<double>& misfits, std::size_t best, double max_rivalry) {
  for (std::size_t i = 1; i + 1 < misfits.size(); ++i) {
    const bool is_elsewhere = i + kRivalSteps <= best || best + kRivalSteps <= i;
    const bool is_dip = misfits[i] <= misfits[i - 1] && misfits[i] <= misfits[i + 1];
    if (is_elsewhere && is_dip && misfits[best] > max_rivalry * misfits[i]) return true;
  }
  return false;
}

/// The height at which views agree, unless they do nowhere, or as well elsewhere. `num_cells` are
/// all there are.
std::optional<Dip> FindDip(const std::vector<StripAgreement>& agreements, const StripWindow& window,
                           double num_cells, const Clarity& clarity) {
  const auto [first, misfits] = MisfitsOf(agreements);
  if (misfits.size() < kMinHeights) return {};
  const auto lowest = std::min_element(misfits.begin(), misfits.end());
  const auto best = static_cast<std::size_t>(lowest - misfits.begin());
  if (best < 2 || best + 3 > misfits.size()) return {};
  const StripAgreement& at = agreements[first + best];
  if (at.num_samples < kMinObservations * at.num_cells || at.num_cells < kMinCells * num_cells)
    return {};
  if (static_cast<double>(at.total) < kMinContrast * kMinContrast * static_cast<double>(at.weight))
    return {};
  std::vector<double> sorted = misfits;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  if (*lowest > clarity.max_misfit * sorted[sorted.size() / 2]) return {};
  const double below = *std::max_element(misfits.begin(), lowest),
               above = *std::max_element(lowest + 1, misfits.end());
  if (*lowest > clarity.max_side * std::min(below, above) ||
      HasRival(misfits, best, clarity.max_rivalry))
    return {};
  // A parabola through the best three.
  const double before = misfits[best - 1], after = misfits[best + 1],
               curvature = before - 2 * *lowest + after;
  if (curvature <= 0) return {};
  const double step = StripWindow::kHeightStep;
  const double variance = 2 * kCorrelation * *lowest * step * step / (curvature * at.num_samples);
  return Dip{
      window.HeightAt(static_cast<double>(first + best) + 0.5 * (before - after) / curvature),
      std::sqrt(variance)};
}

/// Whether what lies farther off is as high: then the step has a level top.
bool IsLevel(const std::vector<StripAgreement>& far_off, double height) {
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

/// The steps of all strips that tell one, however high they are.
std::vector<std::optional<Dip>> MeasureSteps(std::span<const OutlineStrip> strips,
                                             const StripsAlong& along,
                                             std::span<const SweptStrip> beyond,
                                             std::span<const SweptStrip> before,
                                             const KerbOptions& options) {
  const Clarity clear{options.max_misfit, options.max_rivalry, options.max_misfit};
  const Clarity faint{0.97, 0.98, 0.95};  // what the ground's height is, is nearly known
  const double cells_per_strip =
      (StripWindow::kNearRows + StripWindow::kFarRows) * kStripLength / StripWindow::kCellSize;
  std::vector<std::optional<Dip>> steps(strips.size());
  for (std::size_t i = 0; i < strips.size(); ++i) {
    if (beyond[i].num_views < options.min_views) continue;
    const std::vector<std::size_t> around = Around(strips[i], along, kReach);
    const double num_cells = cells_per_strip * (2 * kReach + 1);
    std::optional<Dip> top = FindDip(SumOf(around, beyond, true, true), kBeyond, num_cells, clear);
    if (!top || !IsLevel(SumOf(around, beyond, false, true), top->height)) continue;
    const std::optional<Dip> ground =
        FindDip(SumOf(around, before, true, true), kBefore, num_cells, faint);
    if (ground) top->height -= ground->height;
    top->sigma = std::hypot(top->sigma, ground ? ground->sigma : kUnknownGround, kSigma);
    steps[i] = top;
  }
  return steps;
}

/// Kerbs that strips around them support: chance agrees with nobody.
std::vector<bool> FindSupported(std::span<const OutlineStrip> strips, const StripsAlong& along,
                                std::span<const std::optional<Dip>> steps,
                                const KerbOptions& options) {
  std::vector<bool> is_kerb(strips.size());
  for (std::size_t i = 0; i < strips.size(); ++i) {
    if (!steps[i] || steps[i]->height < options.min_height || steps[i]->height > options.max_height)
      continue;
    int support = -1;  // it agrees with itself
    for (const std::size_t other : Around(strips[i], along, kSupportReach))
      if (steps[other] && std::abs(steps[other]->height - steps[i]->height) <= options.max_jump)
        ++support;
    is_kerb[i] = support >= kMinSupport;
  }
  return is_kerb;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Strips that follow each other along one outline, in this order.
using Run = std::vector<std::size_t>;

Kerb KerbOf(const Run& run, std::span<const OutlineStrip> strips,
            std::span<const std::optional<Dip>> steps) {
  Kerb kerb;
  std::vector<double> heights, sigmas, deviations;
  // The outline has the drivable ground on its left.
  kerb.points.push_back(strips[run.front()].End(-0.5 * kStripLength));
  for (const std::size_t i : run) {
    kerb.points.push_back(strips[i].foot);
    heights.push_back(steps[i]->height);
    sigmas.push_back(steps[i]->sigma);
  }
  kerb.points.push_back(strips[run.back()].End(0.5 * kStripLength));
  kerb.height = Median(heights);
  for (const double height : heights) deviations.push_back(1.4826 * std::abs(height - kerb.height));
  // Strips are asked together with those beside them: so many know something of their own.
  const double num_own = std::max(1.0, static_cast<double>(run.size()) / (2 * kReach + 1));
  kerb.height_sigma =
      std::hypot(std::max(Median(sigmas), Median(deviations)) / std::sqrt(num_own), kSigma);
  return kerb;
}

/// Whether strip `next`, `gap` strips after the last of a run, is of the same kerb.
bool Continues(const Run& run, std::size_t next, int gap, std::span<const OutlineStrip> strips,
               std::span<const std::optional<Dip>> steps, const StripsAlong& along,
               double max_jump) {
  if (gap > kMaxGap) return false;
  std::vector<double> heights;
  for (const std::size_t i : run) heights.push_back(steps[i]->height);
  if (std::abs(steps[next]->height - Median(heights)) > max_jump) return false;
  const OutlineStrip& last = strips[run.back()];
  for (int i = 1; i < gap; ++i) {  // what lies between says nothing
    const auto between = along.find({last.ring, (last.index + i) % last.ring_size});
    if (between != along.end() && steps[between->second]) return false;
  }
  return true;
}

std::vector<Run> FindRuns(std::span<const OutlineStrip> strips,
                          std::span<const std::optional<Dip>> steps,
                          const std::vector<bool>& is_kerb, const StripsAlong& along,
                          double max_jump) {
  std::vector<Run> runs;
  std::size_t first_of_ring = 0;
  const auto close_ring = [&] {  // its end may be followed by its beginning
    if (runs.size() < first_of_ring + 2) return;
    Run &first = runs[first_of_ring], &last = runs.back();
    const OutlineStrip &from = strips[last.back()], &to = strips[first.front()];
    if (!Continues(last, first.front(), to.index + from.ring_size - from.index, strips, steps,
                   along, max_jump))
      return;
    last.insert(last.end(), first.begin(), first.end());
    first = std::move(last);
    runs.pop_back();
  };
  for (std::size_t i = 0; i < strips.size(); ++i) {
    if (i > 0 && strips[i].ring != strips[i - 1].ring) close_ring(), first_of_ring = runs.size();
    if (!is_kerb[i]) continue;
    const bool is_first = runs.size() == first_of_ring;
    const int gap = is_first ? 0 : strips[i].index - strips[runs.back().back()].index;
    if (is_first || !Continues(runs.back(), i, gap, strips, steps, along, max_jump))
      runs.emplace_back();
    runs.back().push_back(i);
  }
  close_ring();
  return runs;
}

}  // namespace

void KerbOptions::Validate() const {
  Require(min_height > 0 && max_height > min_height && max_height < kBeyond.max_height,
          ErrorCode::kUsage, "kerbs: 0 < min_height < max_height < 0.34 m");
  Require(max_distance > 0 && min_views >= 2, ErrorCode::kUsage,
          "kerbs: max_distance > 0 m and min_views >= 2");
  Require(max_misfit > 0 && max_misfit <= 1 && max_rivalry > 0 && max_rivalry <= 1,
          ErrorCode::kUsage, "kerbs: max_misfit and max_rivalry must be in 0..1");
  Require(max_jump > 0 && min_length >= 0, ErrorCode::kUsage,
          "kerbs: max_jump > 0 m and min_length not negative");
}

std::vector<Kerb> FindKerbs(const TriangleMesh& mesh, const SurfaceMap& surface,
                            const PatchSource& patches, std::span<const DrivenPath> paths,
                            const KerbOptions& options) {
  options.Validate();
  const std::vector<OutlineStrip> strips = CutOutline(mesh, surface, kStripLength);
  StripsAlong along;
  for (std::size_t i = 0; i < strips.size(); ++i) along[{strips[i].ring, strips[i].index}] = i;
  const StripViews views{.max_distance = options.max_distance};
  const std::array<StripWindow, 2> windows = {kBeyond, kBefore};
  const auto swept = SweepStrips(strips, kStripLength, patches, paths, windows, views);
  const std::vector<std::optional<Dip>> steps =
      MeasureSteps(strips, along, swept[0], swept[1], options);
  const std::vector<bool> is_kerb = FindSupported(strips, along, steps, options);
  std::vector<Kerb> kerbs;
  for (const Run& run : FindRuns(strips, steps, is_kerb, along, options.max_jump)) {
    Kerb kerb = KerbOf(run, strips, steps);
    if (kerb.Length() >= options.min_length) kerbs.push_back(std::move(kerb));
  }
  return kerbs;
}

}  // namespace parkade

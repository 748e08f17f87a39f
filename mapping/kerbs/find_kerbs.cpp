#include "mapping/kerbs/find_kerbs.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/math/statistics.h"
#include "mapping/kerbs/kerb_gaps.h"
#include "mapping/kerbs/kerb_lines.h"
#include "mapping/kerbs/kerb_looks.h"
#include "mapping/kerbs/kerb_steps.h"
#include "mapping/kerbs/outline_strips.h"
#include "mapping/kerbs/usual_height.h"

namespace parkade {
namespace {

constexpr int kSupportReach = 3;    // strips to each side that may support one ...
constexpr int kMinSupport = 2;      // ... and so many must
constexpr int kMaxGap = 3;          // strips from one to the next of the same kerb
constexpr double kMinLength = 1.0;  // [m] of a kerb

/// Steps that look like kerbs, and those that strips around them support: chance agrees with
/// nobody.
std::vector<bool> FindSupported(std::span<const OutlineStrip> strips,
                                std::span<const KerbLook> looks, const StripsAlong& along,
                                std::span<const std::optional<KerbStep>> steps, double min_height) {
  std::vector<bool> is_kerb(strips.size());
  for (std::size_t i = 0; i < strips.size(); ++i) {
    if (!steps[i] || steps[i]->height < min_height || steps[i]->height > KerbStep::kMaxKerb)
      continue;
    int support = -1;  // it agrees with itself
    for (const std::size_t other : Around(strips[i], along, kSupportReach))
      if (steps[other] && Agree(*steps[other], *steps[i])) ++support;
    is_kerb[i] = support >= kMinSupport || looks[i] == KerbLook::kKerb;
  }
  return is_kerb;
}

/// Strips that follow each other along one outline, in this order.
using Run = std::vector<std::size_t>;

/// The height of a run, by those of its strips that know it best.
KerbStep HeightOf(const Run& run, std::span<const std::optional<KerbStep>> steps) {
  constexpr double kNearlyAsSure = 1.5;
  double least_sigma = steps[run.front()]->sigma;
  for (const std::size_t i : run) least_sigma = std::min(least_sigma, steps[i]->sigma);
  std::vector<double> heights, sigmas;
  for (const std::size_t i : run) {
    if (steps[i]->sigma > kNearlyAsSure * least_sigma) continue;
    heights.push_back(steps[i]->height);
    sigmas.push_back(steps[i]->sigma);
  }
  const double height = Median(heights);
  // Strips share what they know, so that many know no more than one.
  return {height, std::max(Median(sigmas), MadSigma(heights, height))};
}

Kerb KerbOf(const Run& run, std::span<const OutlineStrip> strips,
            std::span<const std::optional<KerbStep>> steps) {
  Kerb kerb;
  // The outline has the drivable ground on its left.
  kerb.points.push_back(strips[run.front()].End(-0.5 * KerbStep::kStripLength));
  for (const std::size_t i : run) kerb.points.push_back(strips[i].foot);
  kerb.points.push_back(strips[run.back()].End(0.5 * KerbStep::kStripLength));
  const KerbStep step = HeightOf(run, steps);
  kerb.height = step.height;
  kerb.height_sigma = step.sigma;
  return kerb;
}

/// Whether strip `next`, `gap` strips after the last of a run, is of the same kerb.
bool Continues(const Run& run, std::size_t next, int gap, std::span<const OutlineStrip> strips,
               std::span<const std::optional<KerbStep>> steps, const StripsAlong& along) {
  if (gap > kMaxGap) return false;
  if (!Agree(*steps[next], HeightOf(run, steps))) return false;
  const OutlineStrip& last = strips[run.back()];
  for (int i = 1; i < gap; ++i) {  // what lies between says nothing
    const auto between = along.find({last.ring, (last.index + i) % last.ring_size});
    if (between != along.end() && steps[between->second]) return false;
  }
  return true;
}

std::vector<Run> FindRuns(std::span<const OutlineStrip> strips,
                          std::span<const std::optional<KerbStep>> steps,
                          const std::vector<bool>& is_kerb, const StripsAlong& along) {
  std::vector<Run> runs;
  std::size_t first_of_ring = 0;
  const auto close_ring = [&] {  // its end may be followed by its beginning
    if (runs.size() < first_of_ring + 2) return;
    Run &first = runs[first_of_ring], &last = runs.back();
    const OutlineStrip &from = strips[last.back()], &to = strips[first.front()];
    if (!Continues(last, first.front(), to.index + from.ring_size - from.index, strips, steps,
                   along))
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
    if (is_first || !Continues(runs.back(), i, gap, strips, steps, along)) runs.emplace_back();
    runs.back().push_back(i);
  }
  close_ring();
  return runs;
}

/// Where strips were seen to be none.
std::vector<NoKerb> DeniedKerbs(std::span<const OutlineStrip> strips,
                                std::span<const KerbLook> looks,
                                std::span<const std::optional<KerbStep>> steps, double min_height) {
  std::vector<NoKerb> denied;
  for (std::size_t i = 0; i < strips.size(); ++i)
    if (looks[i] == KerbLook::kNone || (steps[i] && steps[i]->height < min_height))
      denied.push_back({strips[i].foot, strips[i].along});
  return denied;
}

}  // namespace

void KerbOptions::Validate() const {
  Require(min_height > 0 && min_height < KerbStep::kMaxKerb, ErrorCode::kUsage,
          "kerbs: min_height must be in (0, 0.25) m");
}

std::vector<Kerb> FindKerbs(const TriangleMesh& mesh, const SurfaceMap& surface,
                            const PatchSource& patches, std::span<const DrivenPath> paths,
                            const KerbOptions& options) {
  options.Validate();
  const std::vector<OutlineStrip> strips = CutOutline(mesh, surface, KerbStep::kStripLength);
  StripsAlong along;
  for (std::size_t i = 0; i < strips.size(); ++i) along[{strips[i].ring, strips[i].index}] = i;
  const std::vector<KerbLook> looks = LookBeyond(strips, KerbStep::kStripLength, surface);
  std::vector<std::optional<KerbStep>> steps =
      MeasureSteps(strips, looks, along, options.min_height, patches, paths);
  std::vector<bool> is_kerb = FindSupported(strips, looks, along, steps, options.min_height);
  ContinueLines(strips, looks, along, options.min_height, steps, is_kerb);
  std::vector<Kerb> kerbs;
  for (const Run& run : FindRuns(strips, steps, is_kerb, along)) {
    Kerb kerb = KerbOf(run, strips, steps);
    if (kerb.Length() >= kMinLength) kerbs.push_back(std::move(kerb));
  }
  LeanOnNeighbors(kerbs);
  CloseGaps(surface, DeniedKerbs(strips, looks, steps, options.min_height), kerbs);
  return kerbs;
}

}  // namespace parkade

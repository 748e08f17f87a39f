#include "mapping/markings/find_kerbs.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/statistics.h"
#include "mapping/markings/kerb_steps.h"
#include "mapping/markings/outline_strips.h"

namespace parkade {
namespace {

constexpr int kSupportReach = 3;     // strips to each side that may support one ...
constexpr int kMinSupport = 2;       // ... and so many must
constexpr int kMaxGap = 3;           // strips from one to the next of the same kerb
constexpr double kMaxHeight = 0.22;  // [m]; more is the sill of a car or a wall
constexpr double kMaxJump = 0.03;    // [m] of height along one kerb
constexpr double kMinLength = 2.0;   // [m] of a kerb

/// Kerbs that strips around them support: chance agrees with nobody.
std::vector<bool> FindSupported(std::span<const OutlineStrip> strips, const StripsAlong& along,
                                std::span<const std::optional<KerbStep>> steps, double min_height) {
  std::vector<bool> is_kerb(strips.size());
  for (std::size_t i = 0; i < strips.size(); ++i) {
    if (!steps[i] || steps[i]->height < min_height || steps[i]->height > kMaxHeight) continue;
    int support = -1;  // it agrees with itself
    for (const std::size_t other : Around(strips[i], along, kSupportReach))
      if (steps[other] && std::abs(steps[other]->height - steps[i]->height) <= kMaxJump) ++support;
    is_kerb[i] = support >= kMinSupport;
  }
  return is_kerb;
}

/// Strips that follow each other along one outline, in this order.
using Run = std::vector<std::size_t>;

Kerb KerbOf(const Run& run, std::span<const OutlineStrip> strips,
            std::span<const std::optional<KerbStep>> steps) {
  Kerb kerb;
  std::vector<double> heights, sigmas;
  // The outline has the drivable ground on its left.
  kerb.points.push_back(strips[run.front()].End(-0.5 * KerbStep::kStripLength));
  for (const std::size_t i : run) {
    kerb.points.push_back(strips[i].foot);
    heights.push_back(steps[i]->height);
    sigmas.push_back(steps[i]->sigma);
  }
  kerb.points.push_back(strips[run.back()].End(0.5 * KerbStep::kStripLength));
  kerb.height = Median(heights);
  // Strips are asked together with those beside them: so many know something of their own.
  const double num_own =
      std::max(1.0, static_cast<double>(run.size()) / (2 * KerbStep::kReach + 1));
  kerb.height_sigma =
      std::hypot(std::max(Median(sigmas), MadSigma(heights, kerb.height)) / std::sqrt(num_own),
                 KerbStep::kLeastSigma);
  return kerb;
}

/// Whether strip `next`, `gap` strips after the last of a run, is of the same kerb.
bool Continues(const Run& run, std::size_t next, int gap, std::span<const OutlineStrip> strips,
               std::span<const std::optional<KerbStep>> steps, const StripsAlong& along) {
  if (gap > kMaxGap) return false;
  std::vector<double> heights;
  for (const std::size_t i : run) heights.push_back(steps[i]->height);
  if (std::abs(steps[next]->height - Median(heights)) > kMaxJump) return false;
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

}  // namespace

void KerbOptions::Validate() const {
  Require(min_height > 0 && min_height < kMaxHeight, ErrorCode::kUsage,
          "kerbs: min_height must be in (0, 0.22) m");
}

std::vector<Kerb> FindKerbs(const TriangleMesh& mesh, const SurfaceMap& surface,
                            const PatchSource& patches, std::span<const DrivenPath> paths,
                            const KerbOptions& options) {
  options.Validate();
  const std::vector<OutlineStrip> strips = CutOutline(mesh, surface, KerbStep::kStripLength);
  StripsAlong along;
  for (std::size_t i = 0; i < strips.size(); ++i) along[{strips[i].ring, strips[i].index}] = i;
  const std::vector<std::optional<KerbStep>> steps = MeasureSteps(strips, along, patches, paths);
  const std::vector<bool> is_kerb = FindSupported(strips, along, steps, options.min_height);
  std::vector<Kerb> kerbs;
  for (const Run& run : FindRuns(strips, steps, is_kerb, along)) {
    Kerb kerb = KerbOf(run, strips, steps);
    if (kerb.Length() >= kMinLength) kerbs.push_back(std::move(kerb));
  }
  return kerbs;
}

}  // namespace parkade

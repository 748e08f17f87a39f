#include "mapping/heights/fine_heights.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "mapping/ground/patch_index.h"
#include "mapping/heights/height_sweep.h"
#include "mapping/heights/scanline_costs.h"

namespace parkade {
namespace {

constexpr double kLowest = -0.2, kHighest = 0.35;  // [m] from the field
constexpr double kStep = 0.0125;                   // [m]
constexpr double kMinParallax = 0.8;  // [m per meter of height] views from one side agree anywhere
constexpr double kFineFreedom = 60;   // from which its small cells tell more than larger ones
constexpr double kMaxFreedom = 60;    // neighbors keep their say, however many samples there are
constexpr double kLeastSigma = 0.01;  // [m] at best
constexpr double kMaxSigma = 0.06;    // [m] ground that is known less well is not known
constexpr float kMinEvidence = 1;     // [nats] of a window itself
constexpr double kMaxJump = 0.025;    // [m] of offset between windows that agree
constexpr int kMinSupport = 2;        // windows around one that agree with it
constexpr double kSameDeck = 1.0;     // [m] between cars that looked at a window
constexpr double kShared = 2;         // windows whose errors are much the same

std::vector<float> OffsetsOfSweep() {
  std::vector<float> offsets;
  for (int i = 0; kLowest + i * kStep < kHighest + 0.5 * kStep; ++i)
    offsets.push_back(static_cast<float>(kLowest + i * kStep));
  return offsets;
}

/// Puts costs in the place of what was seen.
void Judge(SweptWindow& window) {
  const bool is_fine = FreedomOf(window.agreements) >= kFineFreedom;
  window.costs.assign(window.agreements.size(), 0);
  if (window.parallax >= kMinParallax)
    window.costs = CostsOf(is_fine ? window.agreements : window.coarse, kMaxFreedom);
  window.agreements = {}, window.coarse = {};
}

/// Where cars of two bins of height looked at one deck, the window that tells more. Sorted by y and
/// x.
std::vector<SweptWindow> OnePerDeck(std::vector<SweptWindow> windows) {
  std::stable_sort(windows.begin(), windows.end(), [](const SweptWindow& a, const SweptWindow& b) {
    return std::tie(a.y, a.x) < std::tie(b.y, b.x);
  });
  std::vector<SweptWindow> kept;
  for (SweptWindow& window : windows) {
    const bool is_same = !kept.empty() && kept.back().x == window.x && kept.back().y == window.y &&
                         std::abs(kept.back().deck_height - window.deck_height) < kSameDeck;
    if (!is_same)
      kept.push_back(std::move(window));
    else if (EvidenceOf(window.costs) > EvidenceOf(kept.back().costs))
      kept.back() = std::move(window);
  }
  return kept;
}

/// Windows that enough of those around them agree with: chance agrees with nobody, and along a kerb
/// there are two at least.
std::vector<bool> FindSupported(std::span<const GridPlace> places,
                                std::span<const std::optional<HeightBelief>> beliefs) {
  PatchIndex index;
  for (const GridPlace& place : places) index.Add(place.x, place.y);
  std::vector<bool> is_supported(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!beliefs[i]) continue;
    int support = -1;  // it agrees with itself
    for (int y = places[i].y - 1; y <= places[i].y + 1; ++y)
      for (int x = places[i].x - 1; x <= places[i].x + 1; ++x)
        for (int other = index.First(x, y); other != PatchIndex::kNone; other = index.Next(other)) {
          const auto k = static_cast<std::size_t>(other);
          support += beliefs[k] && std::abs(places[k].height - places[i].height) < kSameDeck &&
                     std::abs(beliefs[k]->mean - beliefs[i]->mean) < kMaxJump;
        }
    is_supported[i] = support >= kMinSupport;
  }
  return is_supported;
}

}  // namespace

std::vector<HeightObservation> MeasureFineHeights(const PatchSource& patches,
                                                  std::span<const DrivenPath> paths,
                                                  const HeightField& field,
                                                  const MeasureHeightsOptions& options,
                                                  const GroundSquares* only) {
  MeasureHeightsOptions fine = options;
  fine.window = field.spacing();
  const std::vector<float> offsets = OffsetsOfSweep();
  const std::vector<SweptWindow> windows =
      OnePerDeck(SweepWindows(patches, paths, field, offsets, fine, Judge, only));
  std::vector<GridPlace> places;
  std::vector<float> costs;
  for (const SweptWindow& window : windows) {
    places.push_back({window.x, window.y, window.deck_height});
    costs.insert(costs.end(), window.costs.begin(), window.costs.end());
  }
  const std::vector<float> sums = SumAlongScanlines(places, costs, offsets.size(), {});
  std::vector<std::optional<HeightBelief>> beliefs(windows.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    HeightBelief belief =
        BeliefOf(std::span(sums).subspan(i * offsets.size(), offsets.size()), offsets);
    belief.sigma = std::hypot(belief.sigma, kLeastSigma);
    if (belief.sigma <= kMaxSigma && EvidenceOf(windows[i].costs) >= kMinEvidence)
      beliefs[i] = belief;
  }
  const std::vector<bool> is_supported = FindSupported(places, beliefs);
  std::vector<HeightObservation> heights;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (!is_supported[i]) continue;
    const HeightBelief& belief = *beliefs[i];
    const Eigen::Vector2d middle =
        fine.window * Eigen::Vector2d(windows[i].x + 0.5, windows[i].y + 0.5);
    const int patch = field.FindPatch({middle.x(), middle.y(), windows[i].deck_height});
    if (patch == HeightField::kNone) continue;
    heights.push_back({{middle.x(), middle.y(), field.HeightAt(patch, middle) + belief.mean},
                       1 / (belief.sigma * belief.sigma * kShared),
                       belief.sigma});
  }
  return heights;
}

}  // namespace parkade

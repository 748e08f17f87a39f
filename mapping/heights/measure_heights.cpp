#include "mapping/heights/measure_heights.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "mapping/heights/height_sweep.h"

namespace parkade {
namespace {

constexpr double kMinContrast =
    1.5;  // [gray values] of the ground in a window, rms; less shows nothing
constexpr double kMinObservations = 1.5;  // of a cell of a window on average: less agrees by chance
constexpr double kMaxJump = 0.03;         // [m] of correction between windows side by side
constexpr double kLeastSigma = 0.01;      // [m] at best
constexpr int kRivalSteps = 3;  // of the sweep from the best height to what may be another one
constexpr double kMinParallax =
    0.8;  // [m per meter of height] of a window: views from one side agree on any height
constexpr int kMinSupport = 2;          // windows around one that correct the height as it does
constexpr double kMinSignificance = 2;  // sigmas of a minimum below the rest
constexpr double kLeastDip =
    0.03;  // share of a minimum below the rest that lies beyond errors of the model
constexpr double kMostDip = 0.4;  // share that few samples must show
constexpr double kRivalDip =
    0.5;  // part of the share asked for by which it must lie below a dip elsewhere
constexpr int kMaxReach =
    2;  // windows to each side that are asked with one that does not know by itself

/// What the sweep found in one window.
struct WindowHeight {
  HeightObservation observation;
  double offset = 0;  ///< [m] from what was known
  Eigen::Vector2i index;
};

/// Windows that were seen from different sides, by place, and what several of them say together.
class WindowSums {
 public:
  explicit WindowSums(const std::vector<SweptWindow>& windows) {
    for (const SweptWindow& window : windows)
      if (window.parallax >= kMinParallax) at_[{window.deck, window.y, window.x}] = &window;
  }

  /// Over a square of windows, or nothing where less than half of them saw anything.
  std::vector<Agreement> Around(const SweptWindow& center, int reach) const {
    std::vector<Agreement> sums(center.agreements.size());
    int count = 0;
    for (int y = center.y - reach; y <= center.y + reach; ++y)
      for (int x = center.x - reach; x <= center.x + reach; ++x) {
        const auto found = at_.find({center.deck, y, x});
        if (found == at_.end()) continue;
        ++count;
        for (size_t i = 0; i < sums.size(); ++i) sums[i].Add(found->second->agreements[i]);
      }
    const int side = 2 * reach + 1;
    if (2 * count < side * side) sums.clear();
    return sums;
  }

 private:
  std::map<std::tuple<int, int, int>, const SweptWindow*> at_;
};

struct Best {
  double offset = 0, sigma = 0;  ///< [m]
};

/// Share by which the misfit at the best height must lie below that at most heights: more samples
/// show a fainter dip. \param freedom  samples less the cells whose means they gave
double NeededDip(int freedom) {
  const double noise = std::sqrt(2 * kViewCorrelation / freedom);
  return std::clamp(kMinSignificance * noise, kLeastDip, kMostDip);
}

/// The height at which the views agree, unless they do nowhere, or as well elsewhere. `num_cells`
/// make half of what is looked at.
std::optional<Best> FindBest(const std::vector<Agreement>& agreements, int num_cells,
                             double max_offset, const MeasureHeightsOptions& options) {
  const std::vector<double> misfits = MisfitsOf(agreements, 0, 1);
  const auto best =
      static_cast<size_t>(std::min_element(misfits.begin(), misfits.end()) - misfits.begin());
  if (best == 0 || best + 1 >= misfits.size()) return std::nullopt;
  const Agreement& at = agreements[best];
  if (!IsSeenWell(at, {kMinObservations, static_cast<double>(num_cells), kMinContrast}))
    return std::nullopt;
  const int freedom = at.num_samples - at.num_cells;
  const double dip = NeededDip(freedom);
  if (!IsClear(misfits, best, {1 - dip, 1 - kRivalDip * dip, kRivalSteps})) return std::nullopt;
  const double step = max_offset / options.num_steps;
  const std::optional<SweepMinimum> minimum = FitMinimum(misfits, best, step, freedom);
  if (!minimum) return std::nullopt;
  return Best{max_offset * (static_cast<double>(best) / options.num_steps - 1) + minimum->offset,
              std::hypot(kLeastSigma, std::sqrt(minimum->variance))};
}

/// The height of a window by itself or, where its ground shows too little, together with those
/// around: errors of what is known change slowly.
std::optional<WindowHeight> HeightOf(const SweptWindow& window, const WindowSums& sums,
                                     const HeightField& field, double max_offset,
                                     const MeasureHeightsOptions& options) {
  const Eigen::Vector2d center = options.window * Eigen::Vector2d(window.x + 0.5, window.y + 0.5);
  const int patch = field.FindPatch({center.x(), center.y(), window.deck_height});
  if (patch == HeightField::kNone) return std::nullopt;
  const int cells_per_window = static_cast<int>(std::lround(options.window / options.cell_size));
  for (int reach = 0; reach <= kMaxReach; ++reach) {
    const int num_windows = (2 * reach + 1) * (2 * reach + 1);
    const std::vector<Agreement> agreements = sums.Around(window, reach);
    if (agreements.empty()) continue;
    const int half = (reach == 0 ? 2 : 1) * num_windows * cells_per_window * cells_per_window / 4;
    const std::optional<Best> best = FindBest(agreements, half, max_offset, options);
    if (!best) continue;
    const double height = field.HeightAt(patch, center) + best->offset;
    const double variance = best->sigma * best->sigma;
    return WindowHeight{
        {{center.x(), center.y(), height}, 1 / (variance * num_windows), best->sigma},
        best->offset,
        {window.x, window.y}};
  }
  return std::nullopt;
}

/// Heights that some of the windows around them support: chance agrees with nobody. Two windows to
/// both sides support what lies between them, so that a correction may rise.
std::vector<WindowHeight> KeepSupported(const std::vector<WindowHeight>& windows, double max_jump) {
  constexpr double kSameDeck = 1.0;  // [m]
  std::multimap<std::pair<int, int>, const WindowHeight*> at;
  for (const WindowHeight& window : windows)
    at.emplace(std::pair(window.index.x(), window.index.y()), &window);
  const auto offset_beside = [&](const WindowHeight& window, int dx,
                                 int dy) -> std::optional<double> {
    const auto [begin, end] = at.equal_range({window.index.x() + dx, window.index.y() + dy});
    for (auto other = begin; other != end; ++other)
      if (std::abs(other->second->observation.point_in_site.z() -
                   window.observation.point_in_site.z()) < kSameDeck)
        return other->second->offset;
    return std::nullopt;
  };
  std::vector<WindowHeight> kept;
  for (const WindowHeight& window : windows) {
    int support = 0;
    for (const auto& [dx, dy] :
         {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1), std::pair(1, -1)}) {
      const std::optional<double> before = offset_beside(window, -dx, -dy),
                                  after = offset_beside(window, dx, dy);
      const bool is_before = before && std::abs(*before - window.offset) <= max_jump;
      const bool is_after = after && std::abs(*after - window.offset) <= max_jump;
      const bool is_between =
          before && after && std::abs(0.5 * (*before + *after) - window.offset) <= max_jump;
      support += std::max(is_before + is_after, 2 * is_between);
    }
    if (support >= kMinSupport) kept.push_back(window);
  }
  return kept;
}

/// What is known of a window is known of all of it: an observation for each patch of the field,
/// which follow its slope.
std::vector<HeightObservation> SpreadOverWindows(const std::vector<WindowHeight>& windows,
                                                 const HeightField& field, double side) {
  const int count = std::max(1, static_cast<int>(std::lround(side / field.spacing())));
  std::vector<HeightObservation> heights;
  for (const WindowHeight& window : windows)
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < count; ++x) {
        const Eigen::Vector2d place =
            side * (window.index.cast<double>() + Eigen::Vector2d(x + 0.5, y + 0.5) / count);
        const double known = window.observation.point_in_site.z() - window.offset;
        const int patch = field.FindPatch({place.x(), place.y(), known});
        if (patch == HeightField::kNone) continue;
        heights.push_back({{place.x(), place.y(), field.HeightAt(patch, place) + window.offset},
                           window.observation.weight / (count * count),
                           window.observation.sigma});
      }
  return heights;
}

}  // namespace

std::vector<HeightObservation> MeasureHeights(const PatchSource& patches,
                                              std::span<const DrivenPath> paths,
                                              const HeightField& field, double max_offset,
                                              const MeasureHeightsOptions& options,
                                              const GroundSquares* only) {
  std::vector<float> offsets;
  for (int step = -options.num_steps; step <= options.num_steps; ++step)
    offsets.push_back(static_cast<float>(max_offset * step / options.num_steps));
  const std::vector<SweptWindow> swept =
      SweepWindows(patches, paths, field, offsets, options, {}, only);
  const WindowSums sums(swept);
  std::vector<WindowHeight> windows;
  for (const SweptWindow& window : swept)
    if (const auto height = HeightOf(window, sums, field, max_offset, options))
      windows.push_back(*height);
  return SpreadOverWindows(KeepSupported(windows, kMaxJump), field, options.window);
}

}  // namespace parkade

#include "mapping/measure_heights.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/parallel.h"
#include "mapping/meet_surface.h"

namespace parkade {
namespace {

constexpr int kWindowsPerTile = 12;   // a tile is worked on at once: that bounds memory
constexpr double kMinLever = 1.0;     // distance over height of the eye: a steeper view tells no height
constexpr int kRivalSteps = 3;        // of the sweep from the best height to what may be another one
constexpr int kMinSupport = 2;        // windows around one that correct the height as it does
constexpr double kCorrelation = 4.0;  // samples of one view are not independent: variances times this

/// A sample on the surface, and how it moves when the surface rises.
struct Sight {
  Eigen::Vector2f point;  ///< [m] from the tile's corner
  Eigen::Vector2f shift;  ///< [m] per metre of height
  float grey = 0;
  float weight = 0;
};

/// What the sweep found in one window.
struct WindowHeight {
  HeightObservation observation;
  double offset = 0;  ///< [m] from what was known
  Eigen::Vector2i index;
};

/// Which patches are near enough to matter to a tile.
struct Tile {
  Eigen::Vector2d corner;  ///< [m]
  std::vector<size_t> patches;
};

/// Weighted sums over samples.
struct Sums {
  float weight = 0, grey = 0, square = 0;

  void Add(float grey_value, float sample_weight) {
    weight += sample_weight;
    grey += sample_weight * grey_value;
    square += sample_weight * grey_value * grey_value;
  }
  float Residual() const { return weight > 0 ? square - grey * grey / weight : 0; }
};

/// How well views agree over one window at one height.
struct Agreement {
  float residual = 0, total = 0;  ///< of squares: within cells, and altogether
  float weight = 0;
  int num_samples = 0, num_cells = 0;

  double Misfit() const {
    const double freedom = num_samples - num_cells;
    return freedom > 0 && total > 0 ? static_cast<double>(residual) / static_cast<double>(total) * num_samples / freedom
                                    : 1;
  }
};

/// The windows of one tile at all heights of the sweep.
class TileSweep {
 public:
  TileSweep(const Tile& tile, double max_offset, const MeasureHeightsOptions& options)
      : tile_(&tile), options_(&options), max_offset_(max_offset) {
    cells_per_window_ = static_cast<int>(std::lround(options.window / options.cell_size));
    cells_.resize(static_cast<size_t>(kWindowsPerTile * kWindowsPerTile * cells_per_window_ * cells_per_window_));
  }

  std::vector<WindowHeight> Measure(const std::vector<std::vector<Sight>>& views, const HeightField& field,
                                    std::span<const PosedGroundPatch> patches) {
    const int num_heights = 2 * options_->num_steps + 1;
    std::vector<std::vector<Agreement>> agreements;  // by height, then window
    for (int i = 0; i < num_heights; ++i) agreements.push_back(AgreementAt(views, OffsetOf(i)));
    std::vector<WindowHeight> heights;
    for (int window = 0; window < kWindowsPerTile * kWindowsPerTile; ++window) {
      std::vector<Agreement> of_window;
      for (const auto& at_height : agreements) of_window.push_back(at_height[static_cast<size_t>(window)]);
      if (const auto best = FindBest(of_window)) AddHeight(window, *best, field, patches, heights);
    }
    return heights;
  }

 private:
  struct Best {
    double offset = 0, sigma = 0;  ///< [m]
  };

  double OffsetOf(int step) const { return max_offset_ * (step - options_->num_steps) / options_->num_steps; }

  std::vector<Agreement> AgreementAt(const std::vector<std::vector<Sight>>& views, double offset) {
    std::fill(cells_.begin(), cells_.end(), Cell{});
    const int across = kWindowsPerTile * cells_per_window_;
    const auto per_cell = static_cast<float>(1 / options_->cell_size), rise = static_cast<float>(offset);
    std::vector<Sums> windows(static_cast<size_t>(kWindowsPerTile * kWindowsPerTile));
    std::vector<std::pair<int, int>> places;  // cell, window
    for (const std::vector<Sight>& view : views) {
      std::fill(windows.begin(), windows.end(), Sums{});
      places.assign(view.size(), {-1, -1});
      for (size_t i = 0; i < view.size(); ++i) {
        const Eigen::Vector2f place = per_cell * (view[i].point + rise * view[i].shift);
        const int x = static_cast<int>(std::floor(place.x())), y = static_cast<int>(std::floor(place.y()));
        if (x < 0 || y < 0 || x >= across || y >= across) continue;
        const int window = y / cells_per_window_ * kWindowsPerTile + x / cells_per_window_;
        places[i] = {y * across + x, window};
        windows[static_cast<size_t>(window)].Add(view[i].grey, view[i].weight);
      }
      for (size_t i = 0; i < view.size(); ++i) {
        if (places[i].first < 0) continue;
        const Sums& window = windows[static_cast<size_t>(places[i].second)];
        Cell& cell = cells_[static_cast<size_t>(places[i].first)];
        cell.sums.Add(view[i].grey - window.grey / window.weight, view[i].weight);
        ++cell.count;
      }
    }
    return SumUp(across);
  }

  std::vector<Agreement> SumUp(int across) const {
    std::vector<Agreement> agreements(static_cast<size_t>(kWindowsPerTile * kWindowsPerTile));
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x) {
        const Cell& cell = cells_[static_cast<size_t>(y * across + x)];
        const auto index = static_cast<size_t>(y / cells_per_window_ * kWindowsPerTile + x / cells_per_window_);
        Agreement& window = agreements[index];
        window.residual += cell.sums.Residual();
        if (cell.count == 0) continue;
        window.total += cell.sums.square;
        window.weight += cell.sums.weight;
        window.num_samples += cell.count;
        ++window.num_cells;
      }
    return agreements;
  }

  /// The height at which the views agree, unless they do nowhere, or as well elsewhere.
  std::optional<Best> FindBest(const std::vector<Agreement>& agreements) const {
    std::vector<double> misfits;
    for (const Agreement& agreement : agreements) misfits.push_back(agreement.Misfit());
    const auto best = static_cast<size_t>(std::min_element(misfits.begin(), misfits.end()) - misfits.begin());
    if (best == 0 || best + 1 == misfits.size()) return std::nullopt;
    const Agreement& at = agreements[best];
    if (at.num_samples < options_->min_sights * at.num_cells ||
        2 * at.num_cells < cells_per_window_ * cells_per_window_)
      return std::nullopt;
    const double contrast = std::sqrt(static_cast<double>(at.total / std::max(at.weight, 1e-6F)));
    if (contrast < options_->min_contrast) return std::nullopt;
    std::vector<double> sorted = misfits;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    if (misfits[best] > options_->max_misfit * sorted[sorted.size() / 2]) return std::nullopt;
    for (size_t i = 1; i + 1 < misfits.size(); ++i) {
      const bool is_rival = i + kRivalSteps <= best || best + kRivalSteps <= i;
      const bool is_dip = misfits[i] <= misfits[i - 1] && misfits[i] <= misfits[i + 1];
      if (is_rival && is_dip && misfits[best] > options_->max_rivalry * misfits[i]) return std::nullopt;
    }
    // A parabola through the best three.
    const double before = misfits[best - 1], here = misfits[best], after = misfits[best + 1];
    const double curvature = before - 2 * here + after;
    if (curvature <= 0) return std::nullopt;
    const double step = max_offset_ / options_->num_steps;
    // Misfit is a mean of squares over samples: its noise is misfit / n, its second derivative curvature / step^2.
    const double variance = kCorrelation * 2 * here * step * step / (curvature * at.num_samples);
    return Best{OffsetOf(static_cast<int>(best)) + 0.5 * step * (before - after) / curvature,
                std::hypot(options_->sigma, std::sqrt(variance))};
  }

  void AddHeight(int window, const Best& best, const HeightField& field, std::span<const PosedGroundPatch> patches,
                 std::vector<WindowHeight>& heights) const {
    const Eigen::Vector2d center = tile_->corner + options_->window * Eigen::Vector2d(window % kWindowsPerTile + 0.5,
                                                                                      window / kWindowsPerTile + 0.5);
    // Of decks above each other the one that the nearest patch drove on.
    double nearest = 1e9, deck = 0;
    for (const size_t i : tile_->patches) {
      const Eigen::Vector3d& body = patches[i].site_from_body.translation;
      const double distance = (body.head<2>() - center).norm();
      if (distance < nearest) nearest = distance, deck = body.z();
    }
    const int patch = field.FindPatch({center.x(), center.y(), deck});
    if (patch == HeightField::kNone) return;
    const double height = field.HeightAt(patch, center) + best.offset;
    const Eigen::Vector2i index = (center / options_->window).array().floor().matrix().cast<int>();
    heights.push_back({{{center.x(), center.y(), height}, 1 / (best.sigma * best.sigma)}, best.offset, index});
  }

  struct Cell {
    Sums sums;      ///< of grey values
    int count = 0;  ///< of grey values
  };

  const Tile* tile_;
  const MeasureHeightsOptions* options_;
  double max_offset_;
  int cells_per_window_ = 0;
  std::vector<Cell> cells_;
};

/// The samples of a patch that lie on a tile, or may come to.
std::vector<Sight> FindSights(const PosedGroundPatch& posed, const DrivenPath& path, const HeightField& field,
                              const Tile& tile, double max_offset, const MeasureHeightsOptions& options) {
  std::vector<Sight> sights;
  const Eigen::Vector3d eye = posed.site_from_body * path.cameras_in_body[static_cast<size_t>(posed.patch.camera)];
  const double side = kWindowsPerTile * options.window;
  for (const GroundSample& sample : posed.patch.samples) {
    if (!sample.is_free || sample.confidence <= 0) continue;
    Eigen::Vector3d point = posed.site_from_body * sample.point_in_body.cast<double>();
    const Eigen::Vector2d ray = (point - eye).head<2>();
    const double distance = ray.norm();
    if (distance > options.max_distance || distance < kMinLever * (eye.z() - point.z())) continue;
    // Rays meet the surface not far from where they meet the car's plane.
    constexpr double kMargin = 3.0;  // [m]
    const Eigen::Vector2d inside = point.head<2>() - tile.corner;
    if (inside.minCoeff() < -kMargin || inside.maxCoeff() > side + kMargin) continue;
    if (MeetSurface(field, eye, point) == HeightField::kNone) continue;
    const Eigen::Vector2d shift = -(point - eye).head<2>() / (eye.z() - point.z());
    const Eigen::Vector2d on_tile = point.head<2>() - tile.corner;
    const double reach = max_offset * shift.norm();
    if (on_tile.minCoeff() < -reach || on_tile.maxCoeff() > side + reach) continue;
    const float grey = (114.0F * sample.blue + 587.0F * sample.green + 299.0F * sample.red) / 1000;
    sights.push_back({on_tile.cast<float>(), shift.cast<float>(), grey, sample.confidence});
  }
  return sights;
}

/// Tiles by deck: patches that are more than half a deck apart in height do not share one.
std::vector<Tile> MakeTiles(std::span<const PosedGroundPatch> patches, std::span<const DrivenPath> paths,
                            const MeasureHeightsOptions& options) {
  constexpr double kDeckHeight = 1.5;  // [m]
  const double side = kWindowsPerTile * options.window;
  std::map<std::tuple<int, int, int>, Tile> tiles;
  for (size_t i = 0; i < patches.size(); ++i) {
    const DrivenPath* path = FindPath(paths, patches[i].patch.drive);
    if (path == nullptr || static_cast<size_t>(patches[i].patch.camera) >= path->cameras_in_body.size()) continue;
    const Eigen::Vector3d& body = patches[i].site_from_body.translation;
    const auto index = [&](double coordinate) { return static_cast<int>(std::floor(coordinate / side)); };
    const double reach = options.max_distance + 3;
    const int deck = static_cast<int>(std::floor(body.z() / kDeckHeight + 0.5));
    for (int y = index(body.y() - reach); y <= index(body.y() + reach); ++y)
      for (int x = index(body.x() - reach); x <= index(body.x() + reach); ++x) {
        Tile& tile = tiles[{deck, y, x}];
        tile.corner = side * Eigen::Vector2d(x, y);
        tile.patches.push_back(i);
      }
  }
  std::vector<Tile> result;
  for (auto& [key, tile] : tiles) result.push_back(std::move(tile));
  return result;
}

/// Heights that some of the windows around them support: chance agrees with nobody.
std::vector<WindowHeight> KeepSupported(const std::vector<WindowHeight>& windows, double max_jump) {
  constexpr double kSameDeck = 1.0;  // [m]
  std::multimap<std::pair<int, int>, const WindowHeight*> at;
  for (const WindowHeight& window : windows) at.emplace(std::pair(window.index.x(), window.index.y()), &window);
  std::vector<WindowHeight> kept;
  for (const WindowHeight& window : windows) {
    int support = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const auto [begin, end] = at.equal_range({window.index.x() + dx, window.index.y() + dy});
        for (auto other = begin; other != end; ++other)
          if (other->second != &window && std::abs(other->second->offset - window.offset) <= max_jump &&
              std::abs(other->second->observation.point_in_site.z() - window.observation.point_in_site.z()) < kSameDeck)
            ++support;
      }
    if (support >= kMinSupport) kept.push_back(window);
  }
  return kept;
}

/// What is known of a window is known of all of it: an observation for each patch of the field, which follow its slope.
std::vector<HeightObservation> SpreadOverWindows(const std::vector<WindowHeight>& windows, const HeightField& field,
                                                 double side) {
  const int count = std::max(1, static_cast<int>(std::lround(side / field.spacing())));
  std::vector<HeightObservation> heights;
  for (const WindowHeight& window : windows)
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < count; ++x) {
        const Eigen::Vector2d place = side * (window.index.cast<double>() + Eigen::Vector2d(x + 0.5, y + 0.5) / count);
        const double known = window.observation.point_in_site.z() - window.offset;
        const int patch = field.FindPatch({place.x(), place.y(), known});
        if (patch == HeightField::kNone) continue;
        heights.push_back({{place.x(), place.y(), field.HeightAt(patch, place) + window.offset},
                           window.observation.weight / (count * count)});
      }
  return heights;
}

}  // namespace

void MeasureHeightsOptions::Validate() const {
  Require(num_rounds >= 0 && num_steps >= 2, ErrorCode::kUsage, "num_rounds must be >= 0 and num_steps >= 2");
  Require(cell_size > 0 && window >= 2 * cell_size, ErrorCode::kUsage, "window must be two cell_size at least");
  Require(max_offset > 0 && max_distance > 0 && sigma > 0, ErrorCode::kUsage,
          "max_offset, max_distance and sigma must be > 0 m");
  Require(min_contrast >= 0 && max_misfit > 0 && max_rivalry > 0 && min_sights > 1 && max_jump > 0, ErrorCode::kUsage,
          "min_contrast, max_misfit, max_rivalry and max_jump must be > 0, min_sights > 1");
}

std::vector<HeightObservation> MeasureHeights(std::span<const PosedGroundPatch> patches,
                                              std::span<const DrivenPath> paths, const HeightField& field,
                                              double max_offset, const MeasureHeightsOptions& options) {
  const std::vector<Tile> tiles = MakeTiles(patches, paths, options);
  const auto of_tiles = ParallelMap(tiles.size(), [&](size_t t) {
    std::vector<std::vector<Sight>> views;
    for (const size_t i : tiles[t].patches) {
      views.push_back(
          FindSights(patches[i], *FindPath(paths, patches[i].patch.drive), field, tiles[t], max_offset, options));
      if (views.back().empty()) views.pop_back();
    }
    if (views.size() < 2) return std::vector<WindowHeight>{};
    return TileSweep(tiles[t], max_offset, options).Measure(views, field, patches);
  });
  std::vector<WindowHeight> windows;
  for (const auto& of_tile : of_tiles) windows.insert(windows.end(), of_tile.begin(), of_tile.end());
  return SpreadOverWindows(KeepSupported(windows, options.max_jump), field, options.window);
}

}  // namespace parkade

#include "mapping/height_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/parallel.h"
#include "mapping/meet_surface.h"

namespace parkade {
namespace {

constexpr int kWindowsPerTile = 12;  // a tile is worked on at once: that bounds memory
constexpr int kTilesPerBlock = 3;    // the patches of a block are read at once
constexpr size_t kMaxPatches = 300;  // of a block; where a car came by more often, its tiles are worked on one by one
constexpr double kMinLever = 1.0;    // distance over height of the eye: a steeper view tells no height
constexpr double kMargin = 3.0;      // [m] rays meet the surface not further from where they meet the car's plane

/// A sample on the surface, and how it moves when the surface rises.
struct Sight {
  Eigen::Vector2f point;  ///< [m] from the tile's corner
  Eigen::Vector2f shift;  ///< [m] per metre of height
  float grey = 0;         ///< later less the mean of its view in its window
  float weight = 0;
};

/// Where a sample of a patch meets the surface.
struct Meeting {
  Eigen::Vector2f on_plane;  ///< [m] from the block's corner: where it lies on its car's plane ...
  Eigen::Vector2f point;     ///< [m] ... and on the surface
  Eigen::Vector2f shift;     ///< [m] of the latter per metre of height
  float grey = 0, weight = 0;
};

/// Which patches are near enough to matter to a tile.
struct Tile {
  int deck = 0, x = 0, y = 0;   ///< in tiles
  Eigen::Vector2d corner;       ///< [m]
  std::vector<size_t> near;     ///< patches of cars that were near
  std::vector<size_t> patches;  ///< of these, those that reach here
};

/// Tiles side by side, whose patches are read together.
struct Block {
  Eigen::AlignedBox2d box;  ///< [m]
  std::vector<Tile> tiles;
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

/// The windows of one tile at all heights of the sweep.
class TileSweep {
 public:
  TileSweep(const Tile& tile, double max_offset, const MeasureHeightsOptions& options)
      : tile_(&tile), options_(&options), max_offset_(max_offset) {
    cells_per_window_ = static_cast<int>(std::lround(options.window / options.cell_size));
    cells_.resize(static_cast<size_t>(kWindowsPerTile * kWindowsPerTile * cells_per_window_ * cells_per_window_));
  }

  std::vector<SweptWindow> Sweep(const std::vector<std::vector<Sight>>& views, std::span<const PatchView> patches) {
    std::vector<SweptWindow> windows;
    for (int y = 0; y < kWindowsPerTile; ++y)
      for (int x = 0; x < kWindowsPerTile; ++x)
        windows.push_back({tile_->deck, tile_->x * kWindowsPerTile + x, tile_->y * kWindowsPerTile + y, 0, {}});
    for (int step = -options_->num_steps; step <= options_->num_steps; ++step) {
      const std::vector<Agreement> at_height = AgreementAt(views, max_offset_ * step / options_->num_steps);
      for (size_t i = 0; i < windows.size(); ++i) windows[i].agreements.push_back(at_height[i]);
    }
    std::erase_if(windows, [](const SweptWindow& window) {
      return std::all_of(window.agreements.begin(), window.agreements.end(),
                         [](const Agreement& agreement) { return agreement.num_samples == 0; });
    });
    for (SweptWindow& window : windows) window.deck_height = DeckOf(window, patches);
    return windows;
  }

 private:
  struct Cell {
    Sums sums;  ///< of grey values
    int count = 0;
  };

  std::vector<Agreement> AgreementAt(const std::vector<std::vector<Sight>>& views, double offset) {
    std::fill(cells_.begin(), cells_.end(), Cell{});
    const int across = kWindowsPerTile * cells_per_window_;
    const auto per_cell = static_cast<float>(1 / options_->cell_size), rise = static_cast<float>(offset);
    for (const std::vector<Sight>& view : views)
      for (const Sight& sight : view) {
        const float x = per_cell * (sight.point.x() + rise * sight.shift.x());
        const float y = per_cell * (sight.point.y() + rise * sight.shift.y());
        if (x < 0 || y < 0) continue;
        const int column = static_cast<int>(x), row = static_cast<int>(y);
        if (column >= across || row >= across) continue;
        Cell& cell = cells_[static_cast<size_t>(row * across + column)];
        cell.sums.Add(sight.grey, sight.weight);
        ++cell.count;
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

  /// Of decks above each other the one that the nearest patch drove on.
  double DeckOf(const SweptWindow& window, std::span<const PatchView> patches) const {
    const Eigen::Vector2d center = options_->window * Eigen::Vector2d(window.x + 0.5, window.y + 0.5);
    double nearest = 1e9, deck = 0;
    for (const size_t i : tile_->near) {
      const Eigen::Vector3d& body = patches[i].site_from_body.translation;
      const double distance = (body.head<2>() - center).norm();
      if (distance < nearest) nearest = distance, deck = body.z();
    }
    return deck;
  }

  const Tile* tile_;
  const MeasureHeightsOptions* options_;
  double max_offset_;
  int cells_per_window_ = 0;
  std::vector<Cell> cells_;
};

/// The samples of a patch that say something about heights, on the surface.
std::vector<Meeting> FindMeetings(const PosedGroundPatch& posed, const DrivenPath& path, const HeightField& field,
                                  const Eigen::AlignedBox2d& block, double max_distance) {
  std::vector<Meeting> meetings;
  const Eigen::Vector3d eye = posed.site_from_body * path.cameras_in_body[static_cast<size_t>(posed.patch.camera)];
  for (const GroundSample& sample : posed.patch.samples) {
    if (!sample.is_free || sample.confidence <= 0) continue;
    Eigen::Vector3d point = posed.site_from_body * sample.point_in_body.cast<double>();
    const Eigen::Vector2d ray = (point - eye).head<2>(), on_plane = point.head<2>() - block.min();
    if (block.exteriorDistance(point.head<2>().eval()) > 1.5 * kMargin) continue;
    const double distance = ray.norm();
    if (distance > max_distance || distance < kMinLever * (eye.z() - point.z())) continue;
    if (MeetSurface(field, eye, point) == HeightField::kNone) continue;
    const Eigen::Vector2d shift = -(point - eye).head<2>() / (eye.z() - point.z());
    const float grey = (114.0F * sample.blue + 587.0F * sample.green + 299.0F * sample.red) / 1000;
    meetings.push_back({on_plane.cast<float>(), (point.head<2>() - block.min()).cast<float>(), shift.cast<float>(),
                        grey, sample.confidence});
  }
  return meetings;
}

/// Those that lie on a tile, or may come to.
std::vector<Sight> FindSights(const std::vector<Meeting>& meetings, const Eigen::Vector2f& tile_in_block, float side,
                              float max_offset) {
  constexpr auto kReach = static_cast<float>(kMargin);
  std::vector<Sight> sights;
  for (const Meeting& meeting : meetings) {
    const Eigen::Vector2f on_plane = meeting.on_plane - tile_in_block, on_tile = meeting.point - tile_in_block;
    if (on_plane.minCoeff() < -kReach || on_plane.maxCoeff() > side + kReach) continue;
    const float reach = max_offset * meeting.shift.norm();
    if (on_tile.minCoeff() < -reach || on_tile.maxCoeff() > side + reach) continue;
    sights.push_back({on_tile, meeting.shift, meeting.grey, meeting.weight});
  }
  return sights;
}

/// Takes off each window's mean, so that exposures need not agree. Windows just outside of the tile are told apart too.
void TakeOffMeans(double window, std::vector<Sight>& view) {
  constexpr int kAcross = kWindowsPerTile + 2;
  const auto per_window = static_cast<float>(1 / window);
  const auto window_of = [&](const Sight& sight) {
    const Eigen::Array2i index = (per_window * sight.point.array()).floor().cast<int>() + 1;
    const Eigen::Array2i inside = index.max(0).min(kAcross - 1);
    return static_cast<size_t>(inside.y() * kAcross + inside.x());
  };
  std::array<Sums, static_cast<size_t>(kAcross) * kAcross> windows{};
  for (const Sight& sight : view) windows[window_of(sight)].Add(sight.grey, sight.weight);
  for (Sight& sight : view) {
    const Sums& sums = windows[window_of(sight)];
    sight.grey -= sums.grey / sums.weight;
  }
}

int FloorDivide(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

/// Tiles by deck: patches that are more than half a deck apart in height do not share one.
std::vector<Block> MakeBlocks(std::span<const PatchView> patches, std::span<const DrivenPath> paths,
                              const MeasureHeightsOptions& options) {
  constexpr double kDeckHeight = 1.5;  // [m]
  const double side = kWindowsPerTile * options.window;
  std::map<std::tuple<int, int, int>, Tile> tiles;
  for (size_t i = 0; i < patches.size(); ++i) {
    const DrivenPath* path = FindPath(paths, patches[i].drive);
    if (path == nullptr || static_cast<size_t>(patches[i].camera) >= path->cameras_in_body.size()) continue;
    const Eigen::Vector3d& body = patches[i].site_from_body.translation;
    const auto index = [&](double coordinate) { return static_cast<int>(std::floor(coordinate / side)); };
    const double reach = options.max_distance + 3;
    const int deck = static_cast<int>(std::floor(body.z() / kDeckHeight + 0.5));
    for (int y = index(body.y() - reach); y <= index(body.y() + reach); ++y)
      for (int x = index(body.x() - reach); x <= index(body.x() + reach); ++x) {
        Tile& tile = tiles[{deck, y, x}];
        tile.deck = deck, tile.x = x, tile.y = y;
        tile.corner = side * Eigen::Vector2d(x, y);
        tile.near.push_back(i);
        const Eigen::AlignedBox2d reached(tile.corner.array() - kMargin, tile.corner.array() + side + kMargin);
        if (reached.intersects(patches[i].extent)) tile.patches.push_back(i);
      }
  }
  std::map<std::tuple<int, int, int>, Block> blocks;
  for (auto& [key, tile] : tiles) {
    const int x = FloorDivide(tile.x, kTilesPerBlock), y = FloorDivide(tile.y, kTilesPerBlock);
    Block& block = blocks[{tile.deck, y, x}];
    const Eigen::Vector2d corner = kTilesPerBlock * side * Eigen::Vector2d(x, y);
    block.box = {corner, corner.array() + kTilesPerBlock * side};
    block.tiles.push_back(std::move(tile));
  }
  std::vector<Block> result;
  for (auto& [key, block] : blocks) {
    std::set<size_t> of_block;
    for (const Tile& tile : block.tiles) of_block.insert(tile.patches.begin(), tile.patches.end());
    if (of_block.size() <= kMaxPatches) {
      result.push_back(std::move(block));
      continue;
    }
    for (Tile& tile : block.tiles) {
      Block& alone = result.emplace_back();
      alone.box = {tile.corner, tile.corner.array() + side};
      alone.tiles.push_back(std::move(tile));
    }
  }
  return result;
}

/// The patches of a block on the surface, by their number.
std::map<size_t, std::vector<Meeting>> MeetAll(const Block& block, const PatchSource& patches,
                                               std::span<const DrivenPath> paths, const HeightField& field,
                                               double max_distance) {
  std::map<size_t, std::vector<Meeting>> meetings;
  for (const Tile& tile : block.tiles)
    for (const size_t i : tile.patches) meetings.try_emplace(i);
  std::vector<std::pair<const size_t, std::vector<Meeting>>*> list;
  for (auto& of_patch : meetings) list.push_back(&of_patch);
  ParallelFor(list.size(), [&](size_t k) {
    const PosedGroundPatch posed = patches.Read(list[k]->first);
    list[k]->second = FindMeetings(posed, *FindPath(paths, posed.patch.drive), field, block.box, max_distance);
  });
  return meetings;
}

}  // namespace

std::vector<SweptWindow> SweepWindows(const PatchSource& patches, std::span<const DrivenPath> paths,
                                      const HeightField& field, double max_offset,
                                      const MeasureHeightsOptions& options) {
  const auto side = static_cast<float>(kWindowsPerTile * options.window);
  std::vector<SweptWindow> windows;
  for (const Block& block : MakeBlocks(patches.views(), paths, options)) {
    const std::map<size_t, std::vector<Meeting>> meetings = MeetAll(block, patches, paths, field, options.max_distance);
    const auto of_tiles = ParallelMap(block.tiles.size(), [&](size_t t) {
      const Tile& tile = block.tiles[t];
      const Eigen::Vector2f tile_in_block = (tile.corner - block.box.min()).cast<float>();
      std::vector<std::vector<Sight>> views;
      for (const size_t i : tile.patches) {
        views.push_back(FindSights(meetings.at(i), tile_in_block, side, static_cast<float>(max_offset)));
        if (views.back().empty())
          views.pop_back();
        else
          TakeOffMeans(options.window, views.back());
      }
      if (views.size() < 2) return std::vector<SweptWindow>{};
      return TileSweep(tile, max_offset, options).Sweep(views, patches.views());
    });
    for (const auto& of_tile : of_tiles) windows.insert(windows.end(), of_tile.begin(), of_tile.end());
  }
  std::sort(windows.begin(), windows.end(), [](const SweptWindow& a, const SweptWindow& b) {
    return std::tie(a.deck, a.y, a.x) < std::tie(b.deck, b.y, b.x);
  });
  return windows;
}

}  // namespace parkade

#include "mapping/heights/height_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <tuple>

#include "core/parallel.h"
#include "mapping/ground/isometry_of.h"
#include "mapping/ground/largest_first.h"
#include "mapping/heights/intersect_ray.h"
#include "mapping/heights/local_means.h"

namespace parkade {
namespace {

constexpr double kTileSide = 14.4;   // [m] of what one thread sweeps
constexpr size_t kMaxPatches = 250;  // of a block, read at once: that bounds memory
constexpr double kMinLever =
    1.0;  // distance over height of the eye: a steeper view tells no height
constexpr double kMeanAlong = 1.5, kMeanAcross = 0.2;  // [m] the squares of LocalMeans
constexpr double kMargin = 3.0;                        // [m] rays meet the surface not further from
                                                       // where they meet the car's plane ...
constexpr double kMaxShift = 0.375;                    // ... nor this share of the way there

int WindowsPerTile(double window) { return static_cast<int>(std::lround(kTileSide / window)); }

/// [m] of a tile, whole windows.
double SideOf(double window) { return WindowsPerTile(window) * window; }

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

/// The samples of a patch that say something about heights, on the surface.
std::vector<Meeting> FindMeetings(const PosedGroundPatch& posed, const DrivenPath& path,
                                  const HeightField& field, const Eigen::AlignedBox2d& block,
                                  const MeasureHeightsOptions& options, UsedSamples used) {
  std::vector<Meeting> meetings;
  meetings.reserve(posed.patch.samples.size());
  const double max_squared_distance = options.max_distance * options.max_distance;
  PatchFinder patches_at(field);
  const LocalMeans means(posed.patch.samples, kMeanAlong, kMeanAcross, used);
  const Eigen::Isometry3d site_from_body = IsometryOf(posed.site_from_body);
  const Eigen::Vector3d eye =
      site_from_body * path.cameras_in_body[static_cast<size_t>(posed.patch.camera)];
  for (const GroundSample& sample : posed.patch.samples) {
    const float weight = means.WeightOf(sample);
    if (!(weight > 0)) continue;
    Eigen::Vector3d point = site_from_body * sample.point_in_body.cast<double>();
    const double squared_distance = (point - eye).head<2>().squaredNorm(),
                 least = kMinLever * (eye.z() - point.z());
    if (squared_distance > max_squared_distance || (least > 0 && squared_distance < least * least))
      continue;
    if (block.squaredExteriorDistance(point.head<2>().eval()) >
        kMaxShift * kMaxShift * squared_distance)
      continue;
    if (IntersectRay(patches_at, eye, point) == HeightField::kNone) continue;
    const Eigen::Vector2d shift = -(point - eye).head<2>() / (eye.z() - point.z());
    meetings.push_back({(point.head<2>() - block.min()).cast<float>(), shift.cast<float>(),
                        LocalMeans::GrayOf(sample) - means.At(sample), weight});
  }
  return meetings;
}

/// Adds those that lie on a tile, or may come to. \return whether there are any
bool AddObservations(const std::vector<Meeting>& meetings, const Eigen::Vector2f& tile_in_block,
                     float side, float max_offset, TileSweep& sweep) {
  const size_t before = sweep.num_observations();
  sweep.BeginView();
  for (Meeting observation : meetings) {
    observation.point -= tile_in_block;
    const float outside =
        std::max({-observation.point.minCoeff(), observation.point.maxCoeff() - side, 0.0F});
    if (outside * outside > max_offset * max_offset * observation.shift.squaredNorm()) continue;
    sweep.Add(observation);
  }
  return sweep.num_observations() > before;
}

/// Each camera's patches, which are in order of time, as many of every stretch of the drive.
std::vector<size_t> ChooseEvenly(const std::vector<size_t>& indices, size_t max_count,
                                 std::span<const PatchView> patches) {
  if (indices.size() <= max_count) return indices;
  std::map<int, size_t> seen;  // per camera
  std::vector<size_t> chosen;
  for (const size_t i : indices) {
    const size_t number = seen[patches[i].camera]++;
    if ((number + 1) * max_count / indices.size() > number * max_count / indices.size())
      chosen.push_back(i);
  }
  return chosen;
}

/// The patches that reach into any of the tiles.
std::set<size_t> PatchesOf(std::span<const Tile> tiles) {
  std::set<size_t> patches;
  for (const Tile& tile : tiles) patches.insert(tile.patches.begin(), tile.patches.end());
  return patches;
}

/// Tiles of one deck as blocks of kMaxPatches at most, or of one tile: halved where there are too
/// many, so that few patches reach into more than one block.
void MakeBlocks(std::span<Tile> tiles, double side, std::vector<Block>& blocks) {
  Eigen::AlignedBox2d box;
  for (const Tile& tile : tiles)
    box.extend(tile.corner).extend((tile.corner.array() + side).matrix());
  if (tiles.size() <= 1 || PatchesOf(tiles).size() <= kMaxPatches) {
    blocks.push_back(
        {box, {std::make_move_iterator(tiles.begin()), std::make_move_iterator(tiles.end())}});
    return;
  }
  const int axis = box.sizes().x() > box.sizes().y() ? 0 : 1;
  const double middle = box.center()[axis] - 0.25 * side;  // never a tile's corner
  const auto upper = std::stable_partition(
      tiles.begin(), tiles.end(), [&](const Tile& tile) { return tile.corner[axis] < middle; });
  MakeBlocks({tiles.begin(), upper}, side, blocks);
  MakeBlocks({upper, tiles.end()}, side, blocks);
}

/// Tiles by deck: patches that are more than half a deck apart in height do not share one.
std::vector<Tile> MakeTiles(std::span<const PatchView> patches, std::span<const DrivenPath> paths,
                            const MeasureHeightsOptions& options, const GroundSquares* only) {
  constexpr double kDeckHeight = 1.5;  // [m]
  const double side = SideOf(options.window);
  std::map<std::tuple<int, int, int>, Tile> tiles;
  for (size_t i = 0; i < patches.size(); ++i) {
    const DrivenPath* path = FindPath(paths, patches[i].drive);
    if (path == nullptr || static_cast<size_t>(patches[i].camera) >= path->cameras_in_body.size())
      continue;
    const Eigen::Vector3d& body = patches[i].site_from_body.translation;
    const auto index = [&](double coordinate) {
      return static_cast<int>(std::floor(coordinate / side));
    };
    const double reach = options.max_distance + 3;
    const int deck = static_cast<int>(std::floor(body.z() / kDeckHeight + 0.5));
    for (int y = index(body.y() - reach); y <= index(body.y() + reach); ++y)
      for (int x = index(body.x() - reach); x <= index(body.x() + reach); ++x) {
        Tile& tile = tiles[{deck, y, x}];
        tile.deck = deck, tile.x = x, tile.y = y;
        tile.corner = side * Eigen::Vector2d(x, y);
        tile.near.push_back(i);
        const Eigen::AlignedBox2d reached(tile.corner.array() - kMargin,
                                          tile.corner.array() + side + kMargin);
        if (reached.intersects(patches[i].extent)) tile.patches.push_back(i);
      }
  }
  std::vector<Tile> result;
  for (auto& [key, tile] : tiles) {
    const Eigen::Vector2d middle = (tile.corner.array() + 0.5 * side).matrix();
    if (only && !only->Has({middle.x(), middle.y(), 0})) continue;
    tile.patches = ChooseEvenly(tile.patches, static_cast<size_t>(options.max_views), patches);
    if (!tile.patches.empty()) result.push_back(std::move(tile));
  }
  return result;
}

std::vector<Block> MakeBlocks(std::vector<Tile> tiles, double side) {
  std::vector<Block> blocks;
  for (size_t begin = 0, end = 0; begin < tiles.size(); begin = end) {
    while (end < tiles.size() && tiles[end].deck == tiles[begin].deck) ++end;
    MakeBlocks(std::span(tiles).subspan(begin, end - begin), side, blocks);
  }
  return blocks;
}

/// The patches of a block on the surface, by their number.
std::map<size_t, std::vector<Meeting>> MeetAll(const Block& block, const PatchSource& patches,
                                               std::span<const DrivenPath> paths,
                                               const HeightField& field,
                                               const MeasureHeightsOptions& options,
                                               UsedSamples used) {
  std::map<size_t, std::vector<Meeting>> meetings;
  for (const size_t i : PatchesOf(block.tiles)) meetings.try_emplace(i);
  std::vector<std::pair<const size_t, std::vector<Meeting>>*> list;
  list.reserve(meetings.size());
  for (auto& of_patch : meetings) list.push_back(&of_patch);
  ParallelFor(list.size(), [&](size_t k) {
    const PosedGroundPatch posed = patches.Read(list[k]->first);
    list[k]->second =
        FindMeetings(posed, *FindPath(paths, posed.patch.drive), field, block.box, options, used);
  });
  return meetings;
}

/// Among decks above each other, the one that the nearest patch drove on [m].
double DeckOf(const Tile& tile, const Eigen::Vector2d& place, std::span<const PatchView> patches) {
  double nearest = 1e9, deck = 0;
  for (const size_t i : tile.near) {
    const Eigen::Vector3d& body = patches[i].site_from_body.translation;
    const double distance = (body.head<2>() - place).norm();
    if (distance < nearest) nearest = distance, deck = body.z();
  }
  return deck;
}

SweepShape ShapeOf(std::span<const float> offsets, const MeasureHeightsOptions& options) {
  return {WindowsPerTile(options.window),
          static_cast<int>(std::lround(options.window / options.cell_size)),
          static_cast<float>(options.cell_size),
          {offsets.begin(), offsets.end()}};
}

/// The windows of a tile of which anything was seen.
std::vector<SweptWindow> WindowsOf(const Tile& tile, const TileSweep& sweep,
                                   const SweepShape& shape, std::span<const PatchView> patches,
                                   double side, bool is_judged) {
  const int across = shape.num_windows;
  const size_t num_heights = shape.offsets.size();
  std::vector<Agreement> coarse;
  const std::vector<Agreement> agreements = sweep.SweepTwice(is_judged ? &coarse : nullptr);
  const std::vector<float> parallaxes = sweep.Parallaxes();
  std::vector<SweptWindow> windows;
  for (int y = 0; y < across; ++y)
    for (int x = 0; x < across; ++x) {
      const auto begin =
          agreements.begin() + static_cast<std::ptrdiff_t>(num_heights) * (y * across + x);
      const auto end = begin + static_cast<std::ptrdiff_t>(num_heights);
      if (std::all_of(begin, end,
                      [](const Agreement& agreement) { return agreement.num_samples == 0; }))
        continue;
      const Eigen::Vector2i at(tile.x * across + x, tile.y * across + y);
      windows.push_back(
          {.deck = tile.deck,
           .x = at.x(),
           .y = at.y(),
           .deck_height = DeckOf(tile, side * (at.cast<double>().array() + 0.5).matrix(), patches),
           .parallax = static_cast<double>(parallaxes[static_cast<size_t>(y * across + x)]),
           .agreements = {begin, end},
           .coarse = {},
           .costs = {}});
      if (is_judged) {
        const auto from = coarse.begin() + (begin - agreements.begin());
        windows.back().coarse.assign(from, from + (end - begin));
      }
    }
  return windows;
}

}  // namespace

std::vector<SweptWindow> SweepWindows(const PatchSource& patches, std::span<const DrivenPath> paths,
                                      const HeightField& field, std::span<const float> offsets,
                                      const MeasureHeightsOptions& options,
                                      const std::function<void(SweptWindow&)>& judge,
                                      const GroundSquares* only) {
  const auto side = static_cast<float>(SideOf(options.window));
  const SweepShape shape = ShapeOf(offsets, options);
  const float max_offset = std::max(std::abs(offsets.front()), std::abs(offsets.back()));
  std::vector<SweptWindow> windows;
  for (const Block& block :
       MakeBlocks(MakeTiles(patches.views(), paths, options, only), static_cast<double>(side))) {
    const std::map<size_t, std::vector<Meeting>> meetings = MeetAll(
        block, patches, paths, field, options, judge ? UsedSamples::kSeen : UsedSamples::kFree);
    const auto num_patches = [&](size_t t) { return block.tiles[t].patches.size(); };
    const auto of_tiles = ParallelMapLargestFirst(block.tiles.size(), num_patches, [&](size_t t) {
      const Tile& tile = block.tiles[t];
      const Eigen::Vector2f tile_in_block = (tile.corner - block.box.min()).cast<float>();
      TileSweep sweep(shape);
      int num_views = 0;
      for (const size_t i : tile.patches)
        num_views += AddObservations(meetings.at(i), tile_in_block, side, max_offset, sweep);
      if (num_views < 2) return std::vector<SweptWindow>{};
      std::vector<SweptWindow> of_tile =
          WindowsOf(tile, sweep, shape, patches.views(), options.window, judge != nullptr);
      if (judge) std::for_each(of_tile.begin(), of_tile.end(), judge);
      return of_tile;
    });
    for (const auto& of_tile : of_tiles)
      windows.insert(windows.end(), of_tile.begin(), of_tile.end());
  }
  std::sort(windows.begin(), windows.end(), [](const SweptWindow& a, const SweptWindow& b) {
    return std::tie(a.deck, a.y, a.x) < std::tie(b.deck, b.y, b.x);
  });
  return windows;
}

GroundSquares SweepSquares(double window) { return GroundSquares(SideOf(window)); }

}  // namespace parkade

#include "export/gltf/tiles.h"

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "export/gltf/gltf.h"
#include "export/gltf/gltf_geometry.h"
#include "export/gltf/tile_levels.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMinExtent = 0.02;  // [m] never flat: some viewers cull a box without a volume

/// A box around meshes in site.
struct SiteBox {
  Eigen::Vector3d low, high;  ///< [m]

  static SiteBox Around(const TriangleMesh& mesh) {
    const Box3f box = BoundingBox(mesh.vertices);
    const Eigen::Vector3d center = mesh.origin + 0.5 * (box.min + box.max).cast<double>();
    const Eigen::Vector3d half = 0.5 * (box.max - box.min).cast<double>().array().max(kMinExtent);
    return {center - half, center + half};
  }
  void Include(const SiteBox& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  /// A 3D Tiles box: center and three half axes, z up.
  Json ToJson() const {
    const Eigen::Vector3d center = 0.5 * (low + high), half = 0.5 * (high - low);
    return {{"box",
             {center.x(), center.y(), center.z(), half.x(), 0, 0, 0, half.y(), 0, 0, 0, half.z()}}};
  }
};

/// A tile with all that replaces it.
struct Branch {
  SiteBox box;
  Json json;
};
/// The tiles of one level, by square.
using Branches = std::map<std::pair<int, int>, std::vector<Branch>>;

/// Puts the tree of tiles together, from its leaves.
class TileTree {
 public:
  explicit TileTree(const std::function<void(const std::string&, const std::string&)>& write)
      : write_(write) {}

  /// A tile whose finer ones are all there.
  void Add(const MapTile& tile) {
    const auto level = static_cast<size_t>(tile.level);
    if (level >= levels_.size()) levels_.resize(level + 1);
    std::vector<Branch> children;
    for (const int row : {2 * tile.row, 2 * tile.row + 1})
      for (const int column : {2 * tile.column, 2 * tile.column + 1})
        if (level > 0)
          for (Branch& child : levels_[level - 1][{row, column}])
            children.push_back(std::move(child));
    SiteBox box = tile.mesh.empty() ? children.front().box : SiteBox::Around(tile.mesh);
    for (const Branch& child : children) box.Include(child.box);
    Json json = {
        {"boundingVolume", box.ToJson()}, {"geometricError", tile.error}, {"refine", "REPLACE"}};
    if (!tile.mesh.empty()) {
      const std::string uri = "tiles/" + (tile.is_coarsest ? "overview" : tile.name) + ".glb";
      write_(uri, EncodeGltfTile(tile.mesh, tile.texture));
      json["content"] = {{"uri", uri}};
    }
    for (Branch& child : children) json["children"].push_back(std::move(child.json));
    levels_[level][{tile.row, tile.column}].push_back({box, std::move(json)});
    coarsest_error_ = tile.error;
  }

  bool empty() const { return levels_.empty(); }
  Json TakeRoot() { return std::move(levels_.back().begin()->second.front().json); }
  double coarsest_error() const { return coarsest_error_; }

 private:
  const std::function<void(const std::string&, const std::string&)>& write_;
  std::vector<Branches> levels_;
  double coarsest_error_ = 0;
};

}  // namespace

void EncodeTiles(const SiteMap& map,
                 const std::function<void(const std::string&, const std::string&)>& write,
                 const TileOptions& options) {
  TileTree tree(write);
  VisitTiles(map.mesh, map.texture, options.tile_size, options.coarse_cell,
             [&](const MapTile& tile) { tree.Add(tile); });
  Json root = {{"boundingVolume", SiteBox::Around(map.mesh).ToJson()},
               {"geometricError", options.coarse_cell}};
  const double coarsest = tree.empty() ? options.coarse_cell : tree.coarsest_error();
  if (!tree.empty()) root = tree.TakeRoot();
  if (map.datum) root["transform"] = ColumnMajor(EarthFromSite(*map.datum));

  Json tileset = {{"asset", {{"version", "1.1"}, {"generator", "parkade"}}},
                  {"geometricError", 16 * coarsest},
                  {"root", root}};
  // Frames as in the .glb files, in 3D Tiles' words: extras are free.
  if (!map.datum) tileset["asset"]["extras"] = {{"frame", "site"}, {"units", "m"}};
  write("tileset.json", tileset.dump(1) + "\n");
}

}  // namespace parkade

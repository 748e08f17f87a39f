#include "export/tiles.h"

#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <tuple>

#include "export/draco_encoder.h"
#include "export/gltf.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

/// Copies vertices of one mesh to another whose origin lies on the lattice of tiles, each once.
class VertexCopier {
 public:
  VertexCopier(const TriangleMesh& source, const Eigen::Vector3d& origin) : source_(source) { mesh_.origin = origin; }

  void AddTriangle(const std::array<std::uint32_t, 3>& triangle) {
    mesh_.triangles.push_back({Copy(triangle[0]), Copy(triangle[1]), Copy(triangle[2])});
  }
  TriangleMesh Take() { return std::move(mesh_); }

 private:
  std::uint32_t Copy(std::uint32_t index) {
    const auto [entry, is_new] = new_index_.emplace(index, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (!is_new) return entry->second;
    // Rounded in the site: a vertex on the seam is the same in both of its tiles, to the bit.
    const double step = DracoStep(0);
    const Eigen::Vector3d in_site = source_.origin + source_.vertices[index].cast<double>();
    const Eigen::Vector3d on_lattice = (in_site / step).array().round() * step;
    mesh_.vertices.emplace_back((on_lattice - mesh_.origin).cast<float>());
    mesh_.normals.push_back(source_.normals[index]);
    mesh_.colors.push_back(source_.colors[index]);
    mesh_.height_sigmas.push_back(source_.height_sigmas[index]);
    return entry->second;
  }

  const TriangleMesh& source_;
  TriangleMesh mesh_;
  std::map<std::uint32_t, std::uint32_t> new_index_;
};

/// Every vertex moves to the first vertex of its cube; triangles that collapse are left out.
TriangleMesh MergeVertices(const TriangleMesh& mesh, double cell) {
  std::map<std::tuple<long, long, long>, std::uint32_t> first_of_cube;
  std::vector<std::uint32_t> representative(mesh.vertices.size());
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& v = mesh.vertices[i];
    const auto index = [&](float x) { return std::lround(std::floor(static_cast<double>(x) / cell)); };
    representative[i] = first_of_cube.emplace(std::tuple(index(v.x()), index(v.y()), index(v.z())), i).first->second;
  }
  VertexCopier copier(mesh, mesh.origin.array().round());
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::uint32_t, 3> merged = {representative[a], representative[b], representative[c]};
    if (merged[0] != merged[1] && merged[1] != merged[2] && merged[2] != merged[0]) copier.AddTriangle(merged);
  }
  return copier.Take();
}

/// A full-resolution tile.
struct Tile {
  std::string name;  ///< begins with a letter, whatever the signs: "at_-1_0"
  TriangleMesh mesh;
  GroundTexture texture;
};

std::string NameOf(int column, int row, int sheet) {
  std::string name = "at_" + std::to_string(column) + "_" + std::to_string(row);
  if (sheet > 0) name += "_" + std::to_string(sheet);
  return name;
}

/// One tile for each square that holds triangles' centres.
std::vector<Tile> CutIntoSquares(const TriangleMesh& mesh, double tile_size) {
  std::map<std::pair<int, int>, VertexCopier> copiers;
  for (const auto& triangle : mesh.triangles) {
    Eigen::Vector3d centre = mesh.origin;
    for (const std::uint32_t index : triangle) centre += mesh.vertices[index].cast<double>() / 3;
    const std::pair<int, int> square(static_cast<int>(std::floor(centre.y() / tile_size)),
                                     static_cast<int>(std::floor(centre.x() / tile_size)));
    const Eigen::Vector3d origin(square.second * tile_size, square.first * tile_size, std::round(mesh.origin.z()));
    copiers.try_emplace(square, mesh, origin).first->second.AddTriangle(triangle);
  }
  std::vector<Tile> tiles;
  for (auto& [square, copier] : copiers) tiles.push_back({NameOf(square.second, square.first, 0), copier.Take(), {}});
  return tiles;
}

/// One tile for each chart of the texture.
std::vector<Tile> CutIntoCharts(const TriangleMesh& mesh, const GroundTexture& texture) {
  std::vector<Tile> tiles;
  for (const TextureChart& chart : texture.charts) {
    const Eigen::Vector3d origin(chart.column * texture.chart_size, chart.row * texture.chart_size,
                                 std::round(mesh.origin.z()));
    VertexCopier copier(mesh, origin);
    for (const std::uint32_t triangle : chart.triangles) copier.AddTriangle(mesh.triangles[triangle]);
    Tile tile{
        NameOf(chart.column, chart.row, chart.sheet), copier.Take(), {texture.texel_size, texture.chart_size, {}}};
    tile.texture.charts.push_back(chart);
    std::iota(tile.texture.charts[0].triangles.begin(), tile.texture.charts[0].triangles.end(), 0);
    tiles.push_back(std::move(tile));
  }
  return tiles;
}

/// A 3D Tiles box (centre and three half axes, z up) around a mesh in site.
Json BoxAround(const TriangleMesh& mesh) {
  const Box3f box = BoundingBox(mesh.vertices);
  const Eigen::Vector3d centre = mesh.origin + 0.5 * (box.min + box.max).cast<double>();
  // Never flat: some viewers cull a box without a volume.
  const Eigen::Vector3d half = (0.5 * (box.max - box.min).cast<double>()).array().max(0.01);
  return {{"box", {centre.x(), centre.y(), centre.z(), half.x(), 0, 0, 0, half.y(), 0, 0, 0, half.z()}}};
}

}  // namespace

void EncodeTiles(const SiteMap& map, const std::function<void(const std::string&, const std::string&)>& write,
                 const TileOptions& options) {
  Json root = {{"boundingVolume", BoxAround(map.mesh)}, {"geometricError", options.coarse_cell}, {"refine", "REPLACE"}};
  if (map.datum) root["transform"] = ColumnMajor(EarthFromSite(*map.datum));
  const TriangleMesh overview = MergeVertices(map.mesh, options.coarse_cell);
  if (!overview.empty()) {
    write("tiles/overview.glb", EncodeGltfTile(overview));
    root["content"] = {{"uri", "tiles/overview.glb"}};
  }
  Json children = Json::array();
  const std::vector<Tile> tiles =
      map.texture.empty() ? CutIntoSquares(map.mesh, options.tile_size) : CutIntoCharts(map.mesh, map.texture);
  for (const Tile& tile : tiles) {
    const std::string uri = "tiles/" + tile.name + ".glb";
    write(uri, EncodeGltfTile(tile.mesh, tile.texture));
    children.push_back({{"boundingVolume", BoxAround(tile.mesh)}, {"geometricError", 0}, {"content", {{"uri", uri}}}});
  }
  if (!children.empty()) root["children"] = children;

  Json tileset = {{"asset", {{"version", "1.1"}, {"generator", "parkade"}}},
                  {"geometricError", 16 * options.coarse_cell},
                  {"root", root}};
  // Frames as in the .glb files, in 3D Tiles' words: extras are free.
  if (!map.datum) tileset["asset"]["extras"] = {{"frame", "site"}, {"units", "m"}};
  write("tileset.json", tileset.dump(1) + "\n");
}

}  // namespace parkade

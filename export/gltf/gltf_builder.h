#pragma once

#include <tiny_gltf.h>

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "export/gltf/gltf_geometry.h"
#include "export/gltf/mesh_encoding.h"

namespace parkade {

/// Part of a mesh that has one material.
struct GltfPiece {
  GltfGeometry geometry;
  int material = 0;
};

/// Puts one .glb together. Indices returned are those of glTF. Private to export/.
class GltfBuilder {
 public:
  GltfBuilder();

  /// Unlit material; `name` and linear color factor.
  int AddMaterial(const std::string& name, const Eigen::Vector3d& color);
  /// Unlit material with an image: an encoded JPEG.
  int AddTexturedMaterial(const std::string& name, const std::vector<std::uint8_t>& jpeg);
  /// One mesh of several pieces, each with its material. Pieces without triangles are left out; ->
  /// nothing where that leaves none.
  std::optional<int> AddTriangles(const std::string& name, const std::vector<GltfPiece>& pieces,
                                  MeshEncoding encoding);
  /// Throws Error{kInternal} for fewer than two points.
  int AddLineStrip(const std::string& name, const std::vector<Eigen::Vector3f>& points,
                   int material);

  /// A node below `parent` (or of the scene), moved by `translation` [m, y up].
  int AddNode(const std::string& name, std::optional<int> parent,
              const Eigen::Vector3d& translation, std::optional<int> mesh,
              const nlohmann::json& extras = {});

  void SetAssetExtras(const nlohmann::json& extras);

  /// The finished .glb.
  void Write(std::ostream& stream) const;

 private:
  /// Appends bytes on a boundary of 4; `target` as in glTF, or 0.
  int AddBufferView(const void* data, size_t num_bytes, int target);
  int AddAccessor(std::optional<int> buffer_view, int component_type, int type, size_t count,
                  bool is_normalized = false);
  void SetBounds(int accessor, const std::vector<Eigen::Vector3f>& points);
  void AddPlain(const GltfGeometry& geometry, tinygltf::Primitive& primitive);
  void AddDraco(const GltfGeometry& geometry, tinygltf::Primitive& primitive);
  void UseExtension(const std::string& name, bool is_required);

  tinygltf::Model model_;
};

}  // namespace parkade

#include "export/gltf/gltf_builder.h"

#include <algorithm>
#include <ostream>

#include "core/error.h"
#include "export/gltf/draco_encoder.h"

namespace parkade {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kUnlit = "KHR_materials_unlit";

tinygltf::Value ToGltfValue(const nlohmann::json& json) {
  if (json.is_object()) {
    tinygltf::Value::Object object;
    for (const auto& [key, value] : json.items()) object.emplace(key, ToGltfValue(value));
    return tinygltf::Value(object);
  }
  if (json.is_array()) {
    tinygltf::Value::Array array;
    for (const auto& value : json) array.push_back(ToGltfValue(value));
    return tinygltf::Value(array);
  }
  if (json.is_number_integer()) return tinygltf::Value(json.get<int>());
  if (json.is_number()) return tinygltf::Value(json.get<double>());
  if (json.is_boolean()) return tinygltf::Value(json.get<bool>());
  if (json.is_string()) return tinygltf::Value(json.get<std::string>());
  return {};
}

template <typename Value>
size_t NumBytes(const std::vector<Value>& values) {
  return values.size() * sizeof(Value);
}

}  // namespace

GltfBuilder::GltfBuilder() {
  model_.asset.version = "2.0";
  model_.asset.generator = "parkade";
  model_.scenes.resize(1);
  model_.defaultScene = 0;
}

int GltfBuilder::AddMaterial(const std::string& name, const Eigen::Vector3d& color) {
  tinygltf::Material material;
  material.name = name;
  material.doubleSided = true;
  material.pbrMetallicRoughness.baseColorFactor = {color.x(), color.y(), color.z(), 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 1;
  material.extensions[kUnlit] = tinygltf::Value(tinygltf::Value::Object{});
  UseExtension(kUnlit, false);
  model_.materials.push_back(material);
  return static_cast<int>(model_.materials.size()) - 1;
}

int GltfBuilder::AddTexturedMaterial(const std::string& name,
                                     const std::vector<std::uint8_t>& jpeg) {
  tinygltf::Image image;
  image.mimeType = "image/jpeg";
  image.bufferView = AddBufferView(jpeg.data(), jpeg.size(), 0);
  model_.images.push_back(image);
  if (model_.samplers.empty()) {
    tinygltf::Sampler sampler;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    model_.samplers.push_back(sampler);
  }
  tinygltf::Texture texture;
  texture.sampler = 0;
  texture.source = static_cast<int>(model_.images.size()) - 1;
  model_.textures.push_back(texture);
  const int material = AddMaterial(name, Eigen::Vector3d::Ones());
  model_.materials.back().pbrMetallicRoughness.baseColorTexture.index =
      static_cast<int>(model_.textures.size()) - 1;
  return material;
}

std::optional<int> GltfBuilder::AddTriangles(const std::string& name,
                                             const std::vector<GltfPiece>& pieces,
                                             MeshEncoding encoding) {
  tinygltf::Mesh mesh;
  mesh.name = name;
  for (const GltfPiece& piece : pieces) {
    if (piece.geometry.triangles.empty()) continue;
    tinygltf::Primitive& primitive = mesh.primitives.emplace_back();
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = piece.material;
    if (encoding == MeshEncoding::kDraco) {
      AddDraco(piece.geometry, primitive);
    } else {
      AddPlain(piece.geometry, primitive);
    }
  }
  if (mesh.primitives.empty()) return {};
  model_.meshes.push_back(mesh);
  return static_cast<int>(model_.meshes.size()) - 1;
}

int GltfBuilder::AddLineStrip(const std::string& name, const std::vector<Eigen::Vector3f>& points,
                              int material) {
  Require(points.size() >= 2, ErrorCode::kInternal, "a line needs two points");
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_LINE_STRIP;
  primitive.material = material;
  const int view = AddBufferView(points.data(), NumBytes(points), TINYGLTF_TARGET_ARRAY_BUFFER);
  const int positions =
      AddAccessor(view, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, points.size());
  SetBounds(positions, points);
  primitive.attributes["POSITION"] = positions;
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(primitive);
  model_.meshes.push_back(mesh);
  return static_cast<int>(model_.meshes.size()) - 1;
}

int GltfBuilder::AddNode(const std::string& name, std::optional<int> parent,
                         const Eigen::Vector3d& translation, std::optional<int> mesh,
                         const nlohmann::json& extras) {
  tinygltf::Node node;
  node.name = name;
  if (!translation.isZero(0))
    node.translation = {translation.x(), translation.y(), translation.z()};
  if (mesh) node.mesh = *mesh;
  if (!extras.is_null()) node.extras = ToGltfValue(extras);
  const int index = static_cast<int>(model_.nodes.size());
  model_.nodes.push_back(node);
  if (parent) {
    model_.nodes[static_cast<size_t>(*parent)].children.push_back(index);
  } else {
    model_.scenes[0].nodes.push_back(index);
  }
  return index;
}

void GltfBuilder::SetAssetExtras(const nlohmann::json& extras) {
  model_.asset.extras = ToGltfValue(extras);
}

void GltfBuilder::Write(std::ostream& stream) const {
  tinygltf::TinyGLTF writer;
  Require(
      writer.WriteGltfSceneToStream(&model_, stream, /*prettyPrint=*/false, /*writeBinary=*/true),
      ErrorCode::kInternal, "tinygltf could not write the scene");
}

int GltfBuilder::AddBufferView(const void* data, size_t num_bytes, int target) {
  if (model_.buffers.empty()) model_.buffers.resize(1);
  std::vector<unsigned char>& buffer = model_.buffers[0].data;
  buffer.resize((buffer.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = buffer.size();
  view.byteLength = num_bytes;
  view.target = target;
  const auto* bytes = static_cast<const unsigned char*>(data);
  buffer.insert(buffer.end(), bytes, bytes + num_bytes);
  model_.bufferViews.push_back(view);
  return static_cast<int>(model_.bufferViews.size()) - 1;
}

int GltfBuilder::AddAccessor(std::optional<int> buffer_view, int component_type, int type,
                             size_t count, bool is_normalized) {
  tinygltf::Accessor accessor;
  accessor.bufferView = buffer_view.value_or(-1);
  accessor.componentType = component_type;
  accessor.type = type;
  accessor.count = count;
  accessor.normalized = is_normalized;
  model_.accessors.push_back(accessor);
  return static_cast<int>(model_.accessors.size()) - 1;
}

void GltfBuilder::SetBounds(int accessor, const std::vector<Eigen::Vector3f>& points) {
  const Box3f box = BoundingBox(points);
  tinygltf::Accessor& target = model_.accessors[static_cast<size_t>(accessor)];
  for (Eigen::Index i = 0; i < 3; ++i) {
    target.minValues.push_back(static_cast<double>(box.min[i]));
    target.maxValues.push_back(static_cast<double>(box.max[i]));
  }
}

void GltfBuilder::AddPlain(const GltfGeometry& geometry, tinygltf::Primitive& primitive) {
  const size_t count = geometry.positions.size();
  const auto view = [&](const auto& values) {
    return AddBufferView(values.data(), NumBytes(values), TINYGLTF_TARGET_ARRAY_BUFFER);
  };
  const int positions = AddAccessor(view(geometry.positions), TINYGLTF_COMPONENT_TYPE_FLOAT,
                                    TINYGLTF_TYPE_VEC3, count);
  SetBounds(positions, geometry.positions);
  primitive.attributes["POSITION"] = positions;
  primitive.attributes["NORMAL"] =
      AddAccessor(view(geometry.normals), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, count);
  if (!geometry.colors.empty())
    primitive.attributes["COLOR_0"] =
        AddAccessor(view(geometry.colors), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                    TINYGLTF_TYPE_VEC4, count, true);
  if (!geometry.texcoords.empty())
    primitive.attributes["TEXCOORD_0"] = AddAccessor(
        view(geometry.texcoords), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, count);
  primitive.attributes["_HEIGHT_SIGMA"] = AddAccessor(
      view(geometry.height_sigmas), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, count);
  const int indices = AddBufferView(geometry.triangles.data(), NumBytes(geometry.triangles),
                                    TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  primitive.indices = AddAccessor(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                  TINYGLTF_TYPE_SCALAR, 3 * geometry.triangles.size());
}

void GltfBuilder::AddDraco(const GltfGeometry& geometry, tinygltf::Primitive& primitive) {
  const DracoMesh compressed = EncodeDraco(geometry);
  UseExtension(kDraco, true);
  // Accessors say what decoding yields; they have no buffer view of their own.
  const size_t count = compressed.num_vertices;
  const int positions = AddAccessor({}, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, count);
  SetBounds(positions, geometry.positions);
  primitive.attributes["POSITION"] = positions;
  primitive.attributes["NORMAL"] =
      AddAccessor({}, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, count);
  if (!geometry.colors.empty())
    primitive.attributes["COLOR_0"] =
        AddAccessor({}, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, count, true);
  if (!geometry.texcoords.empty())
    primitive.attributes["TEXCOORD_0"] =
        AddAccessor({}, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, count);
  primitive.attributes["_HEIGHT_SIGMA"] =
      AddAccessor({}, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, count);
  primitive.indices = AddAccessor({}, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                                  3 * compressed.num_triangles);
  primitive.extensions[kDraco] = ToGltfValue(
      {{"bufferView", AddBufferView(compressed.bytes.data(), compressed.bytes.size(), 0)},
       {"attributes", compressed.attribute_ids}});
}

void GltfBuilder::UseExtension(const std::string& name, bool is_required) {
  const auto add = [&](std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  add(model_.extensionsUsed);
  if (is_required) add(model_.extensionsRequired);
}

}  // namespace parkade

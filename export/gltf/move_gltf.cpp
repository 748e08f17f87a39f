#include "export/gltf/move_gltf.h"

#include <array>
#include <cstring>
#include <limits>
#include <vector>

#include "core/error.h"
#include "export/gltf/gltf.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123;

[[noreturn]] void Refuse() {
  throw Error(ErrorCode::kInvalidInput, "this is no plain glTF binary of this program");
}

/// The two chunks of a .glb; the second is empty where nothing is shown.
struct Chunks {
  Json json;
  std::string binary;
};

Chunks Split(const std::string& glb) {
  const auto word = [&](size_t at) {
    std::uint32_t value = 0;
    if (at + sizeof value > glb.size()) Refuse();
    std::memcpy(&value, glb.data() + at, sizeof value);
    return value;
  };
  if (word(0) != kMagic || word(4) != 2 || word(16) != kJsonChunk) Refuse();
  const size_t json_bytes = word(12), binary_at = 20 + json_bytes;
  if (binary_at == glb.size()) return {Json::parse(glb.substr(20)), ""};
  if (word(binary_at + 4) != kBinaryChunk || binary_at + 8 + word(binary_at) > glb.size()) Refuse();
  return {Json::parse(glb.substr(20, json_bytes)), glb.substr(binary_at + 8, word(binary_at))};
}

std::string Join(const Chunks& chunks) {
  std::string json = chunks.json.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb;
  const auto word = [&](size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    glb.append(reinterpret_cast<const char*>(&word), sizeof word);
  };
  word(kMagic), word(2),
      word(20 + json.size() + (chunks.binary.empty() ? 0 : 8 + chunks.binary.size()));
  word(json.size()), word(kJsonChunk);
  glb += json;
  if (chunks.binary.empty()) return glb;
  word(chunks.binary.size()), word(kBinaryChunk);
  return glb + chunks.binary;
}

/// Three floats per element, one after the other, within the binary chunk.
class VectorAccessor {
 public:
  VectorAccessor(Chunks& chunks, size_t index)
      : chunks_(chunks), json_(chunks.json.at("accessors").at(index)) {
    const Json& view = chunks.json.at("bufferViews").at(json_.at("bufferView").get<size_t>());
    begin_ = view.value("byteOffset", size_t{0}) + json_.value("byteOffset", size_t{0});
    size_ = json_.at("count").get<size_t>();
    if (json_.at("componentType") != kFloat || json_.at("type") != "VEC3" ||
        view.value("byteStride", 12) != 12 ||
        begin_ + size_ * sizeof(Eigen::Vector3f) > chunks.binary.size())
      Refuse();
  }
  size_t size() const { return size_; }
  Eigen::Vector3d At(size_t i) const {
    Eigen::Vector3f value;
    std::memcpy(value.data(), chunks_.binary.data() + begin_ + i * sizeof value, sizeof value);
    return value.cast<double>();
  }
  void Set(size_t i, const Eigen::Vector3d& value) {
    const Eigen::Vector3f narrow = value.cast<float>();
    std::memcpy(chunks_.binary.data() + begin_ + i * sizeof narrow, narrow.data(), sizeof narrow);
  }
  void SetBounds() {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::max()),
                    high = -low;
    for (size_t i = 0; i < size_; ++i) low = low.cwiseMin(At(i)), high = high.cwiseMax(At(i));
    json_["min"] = {low.x(), low.y(), low.z()};
    json_["max"] = {high.x(), high.y(), high.z()};
  }

 private:
  Chunks& chunks_;
  Json& json_;
  size_t begin_ = 0, size_ = 0;
};

Eigen::Vector3d SiteFromGltf(const Eigen::Vector3d& point) {
  return {point.x(), -point.z(), point.y()};
}
Eigen::Vector3d GltfFromSite(const Eigen::Vector3d& point) {
  return {point.x(), point.z(), -point.y()};
}

/// Shrinks triangles to a point where one of their corners is gone.
void Shrink(Chunks& chunks, size_t accessor, const std::vector<bool>& is_gone) {
  const Json& json = chunks.json.at("accessors").at(accessor);
  const Json& view = chunks.json.at("bufferViews").at(json.at("bufferView").get<size_t>());
  const size_t size = json.at("componentType") == kUnsignedInt     ? 4
                      : json.at("componentType") == kUnsignedShort ? 2
                                                                   : 0;
  const size_t begin = view.value("byteOffset", size_t{0}) + json.value("byteOffset", size_t{0});
  const size_t count = json.at("count").get<size_t>();
  if (size == 0 || count % 3 != 0 || begin + count * size > chunks.binary.size()) Refuse();
  for (size_t i = 0; i < count; i += 3) {
    char* corners = chunks.binary.data() + begin + i * size;
    bool is_kept = true;
    for (size_t k = 0; k < 3; ++k) {
      std::uint32_t index = 0;  // little-endian, as glTF is
      std::memcpy(&index, corners + k * size, size);
      if (index >= is_gone.size()) Refuse();
      is_kept = is_kept && !is_gone[index];
    }
    if (is_kept) continue;
    std::memcpy(corners + size, corners, size);
    std::memcpy(corners + 2 * size, corners, size);
  }
}

/// Where the node goes: near where the first point that stays goes, or else nowhere.
Eigen::Vector3d FindOrigin(Chunks& chunks, const Json& primitives, const Eigen::Vector3d& origin,
                           const PointMotion& motion) {
  for (const Json& primitive : primitives) {
    const VectorAccessor positions(chunks, primitive.at("attributes").at("POSITION").get<size_t>());
    for (size_t i = 0; i < positions.size(); ++i)
      if (const auto moved = motion(SiteFromGltf(origin + positions.At(i))))
        return GltfFromSite(*moved).array().round();
  }
  return origin;
}

void MoveMesh(Chunks& chunks, Json& node, const PointMotion& motion) {
  constexpr double kArm = 0.1;  // [m] along a normal, to see it turn
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (node.contains("translation"))
    for (size_t i = 0; i < 3; ++i)
      origin[static_cast<Eigen::Index>(i)] = node.at("translation").at(i).get<double>();
  const Json primitives =
      chunks.json.at("meshes").at(node.at("mesh").get<size_t>()).at("primitives");
  const Eigen::Vector3d new_origin = FindOrigin(chunks, primitives, origin, motion);
  for (const Json& primitive : primitives) {
    const Json& attributes = primitive.at("attributes");
    VectorAccessor positions(chunks, attributes.at("POSITION").get<size_t>());
    std::optional<VectorAccessor> normals;
    if (attributes.contains("NORMAL"))
      normals.emplace(chunks, attributes.at("NORMAL").get<size_t>());
    std::vector<bool> is_gone(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
      const Eigen::Vector3d point = SiteFromGltf(origin + positions.At(i));
      const std::optional<Eigen::Vector3d> moved = motion(point);
      is_gone[i] = !moved;
      if (!moved) continue;
      const auto tip = normals ? motion(point + kArm * SiteFromGltf(normals->At(i))) : std::nullopt;
      if (tip) normals->Set(i, GltfFromSite((*tip - *moved).normalized()));
      positions.Set(i, GltfFromSite(*moved) - new_origin);
    }
    for (size_t i = 0; i < positions.size(); ++i)  // nobody sees them, but bounds do
      if (is_gone[i]) positions.Set(i, Eigen::Vector3d::Zero());
    positions.SetBounds();
    if (primitive.contains("indices"))
      Shrink(chunks, primitive.at("indices").get<size_t>(), is_gone);
  }
  node["translation"] = {new_origin.x(), new_origin.y(), new_origin.z()};
}

}  // namespace

std::string MoveGltf(const std::string& glb, const PointMotion& motion,
                     const std::set<std::string>& drives, const std::optional<SiteDatum>& datum,
                     const std::string& preview) {
  constexpr std::string_view kDrive = "drive:";
  try {
    Chunks chunks = Split(glb);
    const Json frames = DescribeFrames(datum);
    chunks.json["asset"]["extras"] = frames;
    if (!preview.empty()) chunks.json["asset"]["extras"]["preview"] = preview;
    for (Json& node : chunks.json.at("nodes")) {
      const std::string name = node.value("name", "");
      if (name == "site") node["extras"] = frames;
      if (!node.contains("mesh")) continue;
      if (name.starts_with(kDrive) && !drives.contains(name.substr(kDrive.size())))
        node.erase("mesh");
      else
        MoveMesh(chunks, node, motion);
    }
    return Join(chunks);
  } catch (const Json::exception&) {
    Refuse();
  }
}

}  // namespace parkade

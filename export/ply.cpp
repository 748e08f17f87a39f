#include "export/ply.h"

#include <bit>
#include <cstring>

namespace parkade {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied to the file as they lie in memory");

template <typename Value>
void Append(std::string& bytes, const Value& value) {
  char raw[sizeof(Value)];
  std::memcpy(raw, &value, sizeof(Value));
  bytes.append(raw, sizeof(Value));
}

}  // namespace

std::string EncodePly(const TriangleMesh& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment site frame, z up, meters\n";
  bytes += "element vertex " + std::to_string(mesh.vertices.size()) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    bytes += std::string("property float ") + name + "\n";
  for (const char* name : {"red", "green", "blue"})
    bytes += std::string("property uchar ") + name + "\n";
  bytes += "property float height_sigma\nproperty uchar surface\n";
  bytes += "element face " + std::to_string(mesh.triangles.size()) + "\n";
  bytes += "property list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + 32 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f in_site = (mesh.origin + mesh.vertices[i].cast<double>()).cast<float>();
    for (const float value : {in_site.x(), in_site.y(), in_site.z()}) Append(bytes, value);
    for (const float value : {mesh.normals[i].x(), mesh.normals[i].y(), mesh.normals[i].z()})
      Append(bytes, value);
    for (const std::uint8_t value : mesh.colors[i]) Append(bytes, value);
    Append(bytes, mesh.height_sigmas[i]);
    Append(bytes, mesh.surfaces.empty() ? SurfaceClass::kUnknown : mesh.surfaces[i]);
  }
  for (const auto& triangle : mesh.triangles) {
    Append(bytes, std::uint8_t{3});
    for (const std::uint32_t index : triangle) Append(bytes, static_cast<std::int32_t>(index));
  }
  return bytes;
}

}  // namespace parkade

#include "export/ply.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/export/example_map.h"

namespace parkade {
namespace {

template <typename Value>
Value ValueAt(const std::string& bytes, size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof(Value));
  return value;
}

TEST(Ply, HoldsTheMeshInTheSiteFrame) {
  TriangleMesh mesh = MakeExampleMap(false).mesh;
  mesh.surfaces.assign(mesh.vertices.size(), SurfaceClass::kDrivable);
  mesh.surfaces[7777] = SurfaceClass::kMarking;
  const std::string bytes = EncodePly(mesh);

  const size_t header = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.substr(0, 4), "ply\n");
  EXPECT_NE(bytes.find("element vertex " + std::to_string(mesh.vertices.size()) + "\n"),
            std::string::npos);
  EXPECT_NE(bytes.find("element face " + std::to_string(mesh.triangles.size()) + "\n"),
            std::string::npos);
  // 6 floats, 3 bytes, 1 float, 1 byte; then 1 byte and 3 ints per face.
  ASSERT_EQ(bytes.size(), header + 32 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const size_t i : {size_t{0}, size_t{7777}}) {
    const Eigen::Vector3d in_site = mesh.origin + mesh.vertices[i].cast<double>();
    for (size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(ValueAt<float>(bytes, header + 32 * i + 4 * axis),
                  in_site[static_cast<Eigen::Index>(axis)], 1e-5);
    EXPECT_EQ(ValueAt<std::uint8_t>(bytes, header + 32 * i + 24), mesh.colors[i][0]);
    EXPECT_EQ(ValueAt<std::uint8_t>(bytes, header + 32 * i + 26), mesh.colors[i][2]);
    EXPECT_EQ(ValueAt<float>(bytes, header + 32 * i + 27), mesh.height_sigmas[i]);
    EXPECT_EQ(ValueAt<SurfaceClass>(bytes, header + 32 * i + 31), mesh.surfaces[i]);
  }
  const size_t last_face = bytes.size() - 13;
  EXPECT_EQ(bytes[last_face], 3);
  EXPECT_EQ(ValueAt<std::uint32_t>(bytes, last_face + 9), mesh.triangles.back()[2]);
}

TEST(Ply, AnEmptyMeshIsAHeader) { EXPECT_TRUE(EncodePly({}).ends_with("end_header\n")); }

}  // namespace
}  // namespace parkade

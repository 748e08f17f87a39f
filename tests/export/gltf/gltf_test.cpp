#include "export/gltf/gltf.h"

#include <gtest/gtest.h>

#include <cstring>

#include "export/gltf/draco_encoder.h"
#include "export/gltf/gltf_geometry.h"
#include "tests/export/example_map.h"

// What other programs make of these files is tested in read_maps.mjs.

namespace parkade {
namespace {

/// The JSON chunk of a .glb.
nlohmann::json JsonOf(const std::string& glb) {
  std::uint32_t header[5];
  std::memcpy(header, glb.data(), sizeof header);
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(header[1], 2U);
  EXPECT_EQ(header[2], glb.size());
  return nlohmann::json::parse(glb.substr(20, header[3]));
}

TEST(Gltf, TheSameMapGivesTheSameBytes) {
  for (const MeshEncoding encoding : {MeshEncoding::kPlain, MeshEncoding::kDraco})
    EXPECT_EQ(EncodeGltf(MakeExampleMap(true), encoding),
              EncodeGltf(MakeExampleMap(true), encoding));
}

TEST(Gltf, NodesAreMovedByTheirOriginsTurnedToYUp) {
  const nlohmann::json json = JsonOf(EncodeGltf(MakeExampleMap(false), MeshEncoding::kPlain));
  int num_grounds = 0;
  for (const auto& node : json.at("nodes")) {
    if (node.at("name") != "ground") continue;
    ++num_grounds;
    EXPECT_EQ(node.at("translation"),
              nlohmann::json({3.25, 0.125, 1.5}));  // of (3.25, -1.5, 0.125)
  }
  EXPECT_EQ(num_grounds, 1);
}

TEST(Gltf, NanosecondsOfADrivesSpanAreKept) {
  const nlohmann::json json = JsonOf(EncodeGltf(MakeMapWithoutGround(), MeshEncoding::kDraco));
  const auto& drive = json.at("nodes").back();
  EXPECT_EQ(drive.at("name"), "drive:tuesday_2");
  EXPECT_EQ(drive.at("extras").at("begin_s"), "1403800000.500000000");
  EXPECT_NEAR(drive.at("extras").at("length_m"), 2 * M_PI * 6 * 29 / 30, 0.3);
  EXPECT_FALSE(json.contains("extensionsRequired"));  // nothing is compressed
}

TEST(Gltf, ADriveThatStoodStillHasANodeAndNoLine) {
  SiteMap map;
  TrajectoryState state;
  map.drives.emplace_back().name = "still";
  map.drives[0].site_from_body_trajectory = Trajectory({state});

  const nlohmann::json json = JsonOf(EncodeGltf(map, MeshEncoding::kDraco));

  EXPECT_EQ(json.at("nodes").back().at("name"), "drive:still");
  EXPECT_FALSE(json.at("nodes").back().contains("mesh"));
  EXPECT_FALSE(json.contains("meshes"));
}

TEST(GltfGeometry, LeavesOutWhatNobodyCanSee) {
  TriangleMesh mesh;
  mesh.vertices = {{9, 9, 9}, {0, 0, 1}, {1, 0, 1}, {0, 2, 1}};
  mesh.normals = {{0, 0, 1}, {0, 0, 0}, {0, 0, 5}, {0, 3, 4}};
  mesh.colors.assign(4, {255, 0, 128});
  mesh.height_sigmas.assign(4, 0.1F);
  mesh.triangles = {{1, 2, 3}, {1, 1, 3}};

  const GltfGeometry geometry = MakeGltfGeometry(mesh);

  ASSERT_EQ(geometry.positions.size(), 3U);  // vertex 0 is in no triangle
  ASSERT_EQ(geometry.triangles.size(), 1U);  // the second has no area
  EXPECT_EQ(geometry.positions[2], Eigen::Vector3f(0, 1, -2));
  for (const Eigen::Vector3f& normal : geometry.normals) EXPECT_NEAR(normal.norm(), 1, 1e-6);
  EXPECT_EQ(geometry.normals[0], Eigen::Vector3f(0, 1, 0));  // none given: up
  EXPECT_EQ(geometry.colors[0],
            (std::array<std::uint16_t, 4>{65535, 0, LinearFromSrgb(128), 65535}));
}

TEST(GltfGeometry, ColorsAreLinear) {
  EXPECT_EQ(LinearFromSrgb(0), 0);
  EXPECT_EQ(LinearFromSrgb(255), 65535);
  EXPECT_NEAR(LinearFromSrgb(188) / 65535.0, 0.5, 0.005);
  for (int i = 1; i < 256; ++i)  // every 8-bit value stays distinct
    EXPECT_GT(LinearFromSrgb(static_cast<std::uint8_t>(i)),
              LinearFromSrgb(static_cast<std::uint8_t>(i - 1)));
}

TEST(DracoEncoder, TheStepGrowsOnlyWhereTheBitsRunOut) {
  EXPECT_EQ(DracoStep(0), 1.0 / 512);
  EXPECT_EQ(DracoStep(500), 1.0 / 512);
  EXPECT_EQ(DracoStep(600), 1.0 / 256);
  EXPECT_EQ(DracoStep(5000), 1.0 / 32);
}

}  // namespace
}  // namespace parkade

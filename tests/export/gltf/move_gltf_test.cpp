#include "export/gltf/move_gltf.h"

#include <gtest/gtest.h>

#include <cstring>

#include "core/error.h"
#include "export/gltf/gltf.h"
#include "tests/export/example_map.h"

namespace parkade {
namespace {

/// What a plain .glb shows at a node: points in site, and normals, one after the other.
struct ShownNode {
  std::vector<Eigen::Vector3d> points, normals;
};

nlohmann::json JsonOf(const std::string& glb) {
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, glb.data() + 12, sizeof bytes);
  return nlohmann::json::parse(glb.substr(20, bytes));
}

ShownNode Show(const std::string& glb, const std::string& name) {
  const nlohmann::json json = JsonOf(glb);
  const size_t binary =
      glb.size() - json.at("buffers").at(0).at("byteLength").get<size_t>() / 4 * 4;
  ShownNode shown;
  for (const auto& node : json.at("nodes")) {
    if (node.value("name", "") != name || !node.contains("mesh")) continue;
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    if (node.contains("translation"))
      for (size_t i = 0; i < 3; ++i)
        origin[static_cast<Eigen::Index>(i)] = node["translation"][i].get<double>();
    const auto read = [&](size_t accessor, const Eigen::Vector3d& add,
                          std::vector<Eigen::Vector3d>& values) {
      const auto& view = json.at("bufferViews")
                             .at(json.at("accessors").at(accessor).at("bufferView").get<size_t>());
      for (size_t i = 0; i < json.at("accessors").at(accessor).at("count").get<size_t>(); ++i) {
        Eigen::Vector3f value;
        std::memcpy(value.data(),
                    glb.data() + binary + view.value("byteOffset", size_t{0}) + 12 * i, 12);
        const Eigen::Vector3d point = add + value.cast<double>();
        values.emplace_back(point.x(), -point.z(), point.y());
      }
    };
    for (const auto& primitive :
         json.at("meshes").at(node.at("mesh").get<size_t>()).at("primitives")) {
      read(primitive.at("attributes").at("POSITION"), origin, shown.points);
      if (primitive.at("attributes").contains("NORMAL"))
        read(primitive.at("attributes").at("NORMAL"), Eigen::Vector3d::Zero(), shown.normals);
    }
  }
  return shown;
}

TEST(MoveGltf, ShowsTheMapWhereItLiesNow) {
  const SiteMap map = MakeTexturedMap();
  const std::string before = EncodeGltf(map, MeshEncoding::kPlain);
  const Rigid3 motion{ExpSo3({0, 0.1, 2}), {500, -300, 12}};
  const SiteDatum datum{48, 11, 500};
  std::set<std::string> drives;
  for (const SiteDrive& drive : map.drives) drives.insert(drive.name);
  const std::string after = MoveGltf(
      before, [&](const Eigen::Vector3d& point) { return motion * point; }, drives, datum);

  std::vector<std::string> names = {"ground"};
  for (const std::string& drive : drives) names.push_back("drive:" + drive);
  for (const std::string& name : names) {
    const ShownNode was = Show(before, name), is = Show(after, name);
    ASSERT_EQ(is.points.size(), was.points.size());
    ASSERT_GT(is.points.size(), 2U) << name;
    for (size_t i = 0; i < is.points.size(); ++i)
      EXPECT_LT((is.points[i] - motion * was.points[i]).norm(), 1e-4);
    for (size_t i = 0; i < is.normals.size(); ++i)
      EXPECT_LT((is.normals[i] - motion.rotation * was.normals[i]).norm(), 1e-4);
  }
  EXPECT_EQ(JsonOf(after).at("asset").at("extras").at("datum").at("latitude_deg"), 48);
  EXPECT_EQ(JsonOf(after).at("images"), JsonOf(before).at("images"));
}

TEST(MoveGltf, LeavesOutDrivesThatAreGone) {
  const SiteMap map = MakeExampleMap(false);
  ASSERT_GE(map.drives.size(), 2U);
  const std::string after = MoveGltf(
      EncodeGltf(map, MeshEncoding::kPlain), [](const Eigen::Vector3d& point) { return point; },
      {map.drives[1].name}, std::nullopt);
  EXPECT_TRUE(Show(after, "drive:" + map.drives[0].name).points.empty());
  EXPECT_FALSE(Show(after, "drive:" + map.drives[1].name).points.empty());
}

/// [m^2] of the ground's triangles, of indices of 32 bits.
double AreaOf(const std::string& glb) {
  const nlohmann::json json = JsonOf(glb);
  const size_t binary =
      glb.size() - json.at("buffers").at(0).at("byteLength").get<size_t>() / 4 * 4;
  double area = 0;
  for (const auto& node : json.at("nodes")) {
    if (node.at("name") != "ground") continue;
    size_t first = 0;
    const std::vector<Eigen::Vector3d> points = Show(glb, "ground").points;
    for (const auto& primitive :
         json.at("meshes").at(node.at("mesh").get<size_t>()).at("primitives")) {
      const auto& indices = json.at("accessors").at(primitive.at("indices").get<size_t>());
      const size_t width = indices.at("componentType") == 5125 ? 4 : 2;
      const auto& view = json.at("bufferViews").at(indices.at("bufferView").get<size_t>());
      const auto corner = [&](size_t i) {
        std::uint32_t index = 0;
        std::memcpy(&index, glb.data() + binary + view.value("byteOffset", size_t{0}) + width * i,
                    width);
        return points[first + index];
      };
      for (size_t i = 0; i < indices.at("count").get<size_t>(); i += 3)
        area += 0.5 * (corner(i + 1) - corner(i)).cross(corner(i + 2) - corner(i)).norm();
      first += json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()]["count"]
                   .get<size_t>();
    }
  }
  return area;
}

TEST(MoveGltf, GroundThatIsGoneIsNotShown) {
  const std::string before = EncodeGltf(MakeTexturedMap(), MeshEncoding::kPlain);
  for (const double side : {-1, 1}) {  // that of the first primitive, and another one
    const auto keep = [side](const Eigen::Vector3d& point) {
      return side * point.x() > 0 ? std::optional(point) : std::nullopt;
    };
    const std::string after = MoveGltf(before, keep, {}, std::nullopt);
    for (const Eigen::Vector3d& point : Show(after, "ground").points)
      EXPECT_GT(side * point.x(), -1);
    EXPECT_GT(AreaOf(after), 0.3 * AreaOf(before));
    EXPECT_LT(AreaOf(after), 0.7 * AreaOf(before));
  }
  const std::string none = MoveGltf(
      before, [](const Eigen::Vector3d&) { return std::nullopt; }, {}, std::nullopt);
  EXPECT_EQ(AreaOf(none), 0);
}

TEST(MoveGltf, AnEmptyMapStaysEmpty) {
  const std::string glb = EncodeGltf({}, MeshEncoding::kPlain);
  const std::string after = MoveGltf(
      glb, [](const Eigen::Vector3d& point) { return point; }, {}, SiteDatum{48, 11, 500});
  EXPECT_EQ(JsonOf(after).at("nodes").size(), JsonOf(glb).at("nodes").size());
  EXPECT_EQ(JsonOf(after).at("asset").at("extras").at("datum").at("altitude"), 500);
}

TEST(MoveGltf, RefusesWhatItCannotMove) {
  const PointMotion stay = [](const Eigen::Vector3d& point) { return point; };
  const std::string glb = EncodeGltf(MakeExampleMap(false), MeshEncoding::kPlain);
  for (const std::string& broken :
       {std::string(), std::string("no glTF at all, but long enough"), glb.substr(0, 200),
        glb.substr(0, glb.size() - 9), EncodeGltf(MakeExampleMap(false), MeshEncoding::kDraco)})
    EXPECT_THROW(MoveGltf(broken, stay, {}, std::nullopt), Error);
}

}  // namespace
}  // namespace parkade

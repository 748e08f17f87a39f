#include "tests/simulator/sinks/truth_files.h"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "core/trajectory.h"

namespace parkade::simulator {
namespace {

template <typename T>
void AppendBytes(std::string& content, const T& value) {
  const size_t size = content.size();
  content.resize(size + sizeof(T));
  std::memcpy(content.data() + size, &value, sizeof(T));
}

/// Squares of the world's lattice whose middles are drivable: surfaces that are compared at those
/// middles are compared with the exact outline, and parts of the ground that touch leave no gap.
void AppendSheet(const Place& place, size_t sheet_index, TriangleMesh& mesh) {
  constexpr double kStep = 0.1;  // [m]
  const GroundSheet& sheet = place.ground.sheets()[sheet_index];
  const Eigen::Array2i first = (sheet.min / kStep).array().floor().cast<int>();
  const Eigen::Array2i size = (sheet.max / kStep).array().ceil().cast<int>() - first;
  const auto place_of = [&](double column, double row) {
    return Eigen::Vector2d((first.x() + column) * kStep, (first.y() + row) * kStep);
  };
  std::vector<int> indices(static_cast<size_t>((size.x() + 1) * (size.y() + 1)), -1);
  const auto vertex = [&](int column, int row) {
    int& index = indices[static_cast<size_t>(row * (size.x() + 1) + column)];
    if (index < 0) {
      index = static_cast<int>(mesh.vertices.size());
      const Eigen::Vector2d xy = place_of(column, row);
      const double height = sheet.height(xy);
      mesh.vertices.push_back(Eigen::Vector3d(xy.x(), xy.y(), height).cast<float>());
      mesh.normals.push_back(place.ground.Normal(xy, height).cast<float>());
    }
    return static_cast<std::uint32_t>(index);
  };
  for (int row = 0; row < size.y(); ++row) {
    for (int column = 0; column < size.x(); ++column) {
      const Eigen::Vector2d center = place_of(column + 0.5, row + 0.5);
      if (!sheet.Covers(center) || !place.is_drivable(sheet_index, center)) continue;
      const std::uint32_t a = vertex(column, row), b = vertex(column + 1, row),
                          c = vertex(column + 1, row + 1), d = vertex(column, row + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
}

}  // namespace

TriangleMesh DrivableSurface(const Place& place) {
  TriangleMesh mesh;
  for (size_t sheet = 0; sheet < place.ground.sheets().size(); ++sheet)
    AppendSheet(place, sheet, mesh);
  return mesh;
}

void WriteSlots(const Place& place, const SiteDatum& datum, const std::filesystem::path& file) {
  nlohmann::json features = nlohmann::json::array();
  for (const ParkingSlot& slot : place.slots) {
    nlohmann::json ring = nlohmann::json::array();
    for (const int corner : {0, 1, 2, 3, 0}) {
      const Eigen::Vector2d xy = slot.outline.Corner(corner);
      const Geodetic at = GeodeticFromSite(datum, {xy.x(), xy.y(), slot.height});
      ring.push_back({at.longitude_deg, at.latitude_deg, at.altitude});
    }
    const Eigen::Vector2d &center = slot.outline.center, &half = slot.outline.half_size;
    features.push_back({{"type", "Feature"},
                        {"geometry", {{"type", "Polygon"}, {"coordinates", {ring}}}},
                        {"properties",
                         {{"kind", slot.kind},
                          {"is_occupied", slot.is_occupied},
                          {"center", {center.x(), center.y(), slot.height}},
                          {"size", {2 * half.x(), 2 * half.y()}},
                          {"yaw", slot.outline.yaw}}}});
  }
  const nlohmann::json collection = {{"type", "FeatureCollection"}, {"features", features}};
  WriteFileAtomically(file, collection.dump() + "\n");
}

void WriteKerbs(std::span<const KerbStone> kerbs, const SiteDatum& datum,
                const std::filesystem::path& file) {
  nlohmann::json features = nlohmann::json::array();
  for (const KerbStone& stone : kerbs) {
    nlohmann::json places = nlohmann::json::array(), line = nlohmann::json::array();
    for (const Eigen::Vector3d& point : {stone.begin, stone.end}) {
      const Geodetic at = GeodeticFromSite(datum, point);
      places.push_back({at.longitude_deg, at.latitude_deg, at.altitude});
      line.push_back({point.x(), point.y(), point.z()});
    }
    features.push_back(
        {{"type", "Feature"},
         {"geometry", {{"type", "LineString"}, {"coordinates", places}}},
         {"properties", {{"type", "kerb"}, {"height_m", stone.height}, {"line", line}}}});
  }
  const nlohmann::json collection = {{"type", "FeatureCollection"}, {"features", features}};
  WriteFileAtomically(file, collection.dump() + "\n");
}

void WritePly(const TriangleMesh& mesh, const std::filesystem::path& file) {
  std::string content =
      "ply\nformat binary_little_endian 1.0\ncomment drivable ground, meters, z up\nelement "
      "vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) +
      "\nproperty list uchar int vertex_indices\nend_header\n";
  content.reserve(content.size() + 12 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) AppendBytes(content, vertex[axis]);
  for (const auto& triangle : mesh.triangles) {
    AppendBytes(content, std::uint8_t{3});
    for (const std::uint32_t index : triangle)
      AppendBytes(content, static_cast<std::int32_t>(index));
  }
  WriteFileAtomically(file, content);
}

void WriteTruthTrajectory(const Motion& motion, const Rigid3& body_from_imu, Timestamp epoch,
                          const std::filesystem::path& file) {
  constexpr double kRate = 200;  // [Hz]
  std::vector<TimedPose> poses;
  for (int i = 0; i <= static_cast<int>(motion.Duration() * kRate); ++i) {
    const Timestamp time = epoch + i / kRate;
    poses.push_back({time, motion.WorldFromBody(time - epoch) * body_from_imu});
  }
  WriteTum(poses, file);
}

}  // namespace parkade::simulator

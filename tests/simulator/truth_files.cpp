#include "tests/simulator/truth_files.h"

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/trajectory.h"

namespace parkade::simulator {
namespace {

template <typename T>
void AppendBytes(std::string& content, const T& value) {
  const size_t size = content.size();
  content.resize(size + sizeof(T));
  std::memcpy(content.data() + size, &value, sizeof(T));
}

}  // namespace

TriangleMesh DrivableSurface(const LotLayout& layout, const Terrain& terrain) {
  constexpr double kStep = 0.1;  // [m]
  const int columns = static_cast<int>(layout.length / kStep), rows = static_cast<int>(layout.width / kStep);
  TriangleMesh mesh;
  std::vector<int> indices(static_cast<size_t>((columns + 1) * (rows + 1)), -1);
  const auto vertex = [&](int column, int row) {
    int& index = indices[static_cast<size_t>(row * (columns + 1) + column)];
    if (index < 0) {
      index = static_cast<int>(mesh.vertices.size());
      const double x = kStep * column, y = kStep * row;
      mesh.vertices.push_back(Eigen::Vector3d(x, y, terrain.Height(x, y)).cast<float>());
      mesh.normals.push_back(terrain.Normal(x, y).cast<float>());
    }
    return static_cast<std::uint32_t>(index);
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (!layout.IsDrivable({kStep * (column + 0.5), kStep * (row + 0.5)})) continue;
      const std::uint32_t a = vertex(column, row), b = vertex(column + 1, row), c = vertex(column + 1, row + 1),
                          d = vertex(column, row + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

void WritePly(const TriangleMesh& mesh, const std::filesystem::path& file) {
  std::string content =
      "ply\nformat binary_little_endian 1.0\ncomment drivable ground, metres, z up\nelement vertex " +
      std::to_string(mesh.vertices.size()) + "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  content.reserve(content.size() + 12 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) AppendBytes(content, vertex[axis]);
  for (const auto& triangle : mesh.triangles) {
    AppendBytes(content, std::uint8_t{3});
    for (const std::uint32_t index : triangle) AppendBytes(content, static_cast<std::int32_t>(index));
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

#include "tests/export/example_map.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <tuple>
#include <utility>

#include "export/gltf/gltf.h"

namespace parkade {
namespace {

constexpr double kCellSize = 0.25;

/// The lower deck, 160 x 80 cells, with a gentle fall and a hole where a pillar stands.
FileBackedVector<SurfaceCell> LowerDeck() {
  FileBackedVector<SurfaceCell> cells;
  for (int y = -40; y < 40; ++y) {
    for (int x = -80; x < 80; ++x) {
      if (x >= -10 && x < -6 && y >= 4 && y < 8) continue;  // a pillar of 1 m x 1 m
      SurfaceCell cell;
      cell.x = x;
      cell.y = y;
      cell.height = static_cast<float>(0.01 * y * kCellSize);
      cell.height_sigma = 0.005F + 0.0001F * static_cast<float>(std::abs(x));
      cell.free_belief = y < 36 ? 0.95F : 0.2F;  // the north edge is a kerb
      const int shade = 60 + (x * 7 + y * 13) % 20;
      const bool is_line = x % 10 == 0 && y > 16;
      const auto gray = static_cast<std::uint8_t>(is_line ? 230 : shade);
      cell.color = {gray, gray, static_cast<std::uint8_t>(gray - 5)};
      cells.push_back(cell);
    }
  }
  return cells;
}

/// A ramp outside of the lower deck's south edge, then the upper deck above the east half.
FileBackedVector<SurfaceCell> RampAndUpperDeck() {
  FileBackedVector<SurfaceCell> cells;
  SurfaceCell cell;
  cell.height_sigma = 0.01F;
  cell.free_belief = 0.9F;
  cell.color = {120, 110, 100};
  for (int y = -56; y < -40; ++y) {
    for (int x = -80; x < 20; ++x) {
      cell.x = x;
      cell.y = y;
      cell.height =
          static_cast<float>(std::clamp((x + 70) * kCellSize * 0.12, 0.0, kUpperDeckHeight) - 0.1);
      cells.push_back(cell);
    }
  }
  for (int y = -56; y < 40; ++y) {
    for (int x = 20; x < 80; ++x) {
      cell.x = x;
      cell.y = y;
      cell.height = static_cast<float>(kUpperDeckHeight - 0.1);
      cells.push_back(cell);
    }
  }
  return cells;
}

/// Two triangles per square of four neighboring cell centers of similar height.
TriangleMesh MeshOf(const SurfaceMap& surface) {
  TriangleMesh mesh;
  mesh.origin = {3.25, -1.5, 0.125};
  std::map<std::tuple<int, int, int>, std::uint32_t> vertex_of;  // by x, y, deck
  const auto deck_of = [](const SurfaceCell& cell) {
    return cell.y < -40 ? 1 : (cell.height > 1.5F ? 1 : 0);
  };
  for (const SurfaceCell& cell : surface.cells) {
    vertex_of[{cell.x, cell.y, deck_of(cell)}] = static_cast<std::uint32_t>(mesh.vertices.size());
    const Eigen::Vector3d in_site((cell.x + 0.5) * kCellSize, (cell.y + 0.5) * kCellSize,
                                  static_cast<double>(cell.height));
    mesh.vertices.emplace_back((in_site - mesh.origin).cast<float>());
    mesh.normals.emplace_back(Eigen::Vector3f(0.0F, -0.01F, 1.0F).normalized());
    mesh.colors.push_back(cell.color);
    mesh.height_sigmas.push_back(cell.height_sigma);
  }
  for (const auto& [key, corner] : vertex_of) {
    const auto& [x, y, deck] = key;
    const auto east = vertex_of.find({x + 1, y, deck}), north = vertex_of.find({x, y + 1, deck}),
               across = vertex_of.find({x + 1, y + 1, deck});
    if (east == vertex_of.end() || north == vertex_of.end() || across == vertex_of.end()) continue;
    mesh.triangles.push_back({corner, east->second, across->second});
    mesh.triangles.push_back({corner, across->second, north->second});
  }
  return mesh;
}

/// A loop over the lower deck; the odometry of 100 Hz drifts in yaw and scale, the final states
/// come at 4 Hz.
SiteDrive MakeDrive(const std::string& name, double radius, double begin_seconds) {
  constexpr int kNumStates = 3000;
  std::vector<TrajectoryState> odometry, final_states;
  for (int i = 0; i < kNumStates; ++i) {
    const double angle = 2 * M_PI * i / kNumStates, drift = 1 + 0.01 * i / kNumStates;
    const auto pose_at = [&](double a, double r) {
      return Rigid3{Eigen::Quaterniond(Eigen::AngleAxisd(a + M_PI / 2, Eigen::Vector3d::UnitZ())),
                    {r * std::cos(a), r * std::sin(a), 0.01 * r * std::sin(a)}};
    };
    TrajectoryState state;
    state.time = TimestampFromSeconds(begin_seconds) + 0.01 * i;
    state.world_from_body = pose_at(angle * drift, radius * drift);
    const double sigma =
        0.1 * i / kNumStates;  // along x, y, z in odom: this, its half and its quarter
    state.covariance.diagonal() << 1e-6, 1e-6, 4e-6, sigma * sigma, sigma * sigma / 4,
        sigma * sigma / 16;
    odometry.push_back(state);
    if (i % 25 != 0 || i < 50 || i > kNumStates - 50) continue;
    state.world_from_body = pose_at(angle, radius);
    final_states.push_back(state);
  }
  SiteDrive drive;
  drive.name = name;
  drive.rig.body_from_imu.translation = {1.2, 0, 0.6};
  drive.odometry = Trajectory(odometry);
  drive.site_from_body_trajectory = Trajectory(final_states);
  return drive;
}

}  // namespace

SiteMap MakeExampleMap(bool is_georeferenced) {
  SiteMap map = MakeMapWithoutGround();
  map.surface.cell_size = kCellSize;
  map.surface.cells = LowerDeck();
  for (const SurfaceCell& cell : RampAndUpperDeck()) map.surface.cells.push_back(cell);
  std::sort(map.surface.cells.begin(), map.surface.cells.end(),
            [](const SurfaceCell& a, const SurfaceCell& b) {
              return std::tuple(a.y, a.x, a.height) < std::tuple(b.y, b.x, b.height);
            });
  map.mesh = MeshOf(map.surface);
  if (is_georeferenced) {
    map.datum = SiteDatum{48.1372, 11.5756, 520};
    map.placement.emplace().covariance.diagonal() << 1e-6, 0.04, 0.04, 0.09;
  }
  return map;
}

SiteMap MakeTexturedMap() {
  SiteMap map = MakeExampleMap(false);
  map.texture.texel_size = 0.1;
  map.texture.chart_size = 16;
  std::map<std::tuple<int, int, int>, TextureChart> charts;
  for (std::uint32_t i = 0; i < map.mesh.triangles.size(); ++i) {
    Eigen::Vector3d center = map.mesh.origin;
    for (const std::uint32_t vertex : map.mesh.triangles[i])
      center += map.mesh.vertices[vertex].cast<double>() / 3;
    const auto index = [](double value) { return static_cast<int>(std::floor(value / 16)); };
    const std::tuple key(index(center.y()), index(center.x()),
                         center.z() > 0.5 * kUpperDeckHeight ? 1 : 0);
    charts[key].triangles.push_back(i);
  }
  for (auto& [key, chart] : charts) {
    std::tie(chart.row, chart.column, chart.layer) = key;
    chart.left = -25;
    chart.top = 15;
    chart.image = cv::Mat(300, 500, CV_8UC3);
    chart.mask = cv::Mat(300, 500, CV_8UC1, cv::Scalar(255));
    for (int row = 0; row < 300; ++row)
      for (int column = 0; column < 500; ++column)
        chart.image.at<cv::Vec3b>(row, column) = {128, static_cast<uchar>(255 * row / 300),
                                                  static_cast<uchar>(255 * column / 500)};
    map.texture.charts.push_back(chart);
  }
  return map;
}

SiteMap MakeMapWithoutGround() {
  SiteMap map;
  map.drives.push_back(MakeDrive("monday", 8, 1403715285));
  map.drives.push_back(MakeDrive("tuesday_2", 6, 1403800000));
  return map;
}

SiteMap MakeMapOfNoManifold() {
  SiteMap map;
  map.mesh.vertices = {{0, 0, 0},    {1, 0, 0}, {0, 1, 0}, {0, -1, 0.5F},
                       {0.5F, 0, 1}, {2, 0, 0}, {2, 1, 0}};
  map.mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 5, 6}};
  map.mesh.normals.assign(7, Eigen::Vector3f::UnitZ());
  map.mesh.colors.assign(7, {200, 100, 50});
  map.mesh.height_sigmas.assign(7, 0.02F);
  return map;
}

std::string EncodeGltf(const SiteMap& map, MeshEncoding encoding) {
  std::ostringstream stream;
  WriteGltf(map, encoding, stream);
  return std::move(stream).str();
}

}  // namespace parkade

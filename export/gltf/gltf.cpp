#include "export/gltf/gltf.h"

#include <sstream>

#include "export/gltf/gltf_builder.h"
#include "export/gltf/texture_jpeg.h"

namespace parkade {
namespace {

// Points of a line closer than this to the one before are left out: a standing car would give
// thousands.
constexpr double kMinLineStep = 0.05;  // [m]

// Linear RGB of the drives' lines, in turn: distinct for color-blind people too (Okabe, Ito).
const Eigen::Vector3d kDriveColors[] = {{0.791, 0.112, 0.0}, {0.0, 0.168, 0.445},
                                        {0.0, 0.342, 0.171}, {0.604, 0.191, 0.386},
                                        {0.791, 0.347, 0.0}, {0.093, 0.456, 0.815}};

/// Positions of the body [m, y up] relative to `origin` (in site).
std::vector<Eigen::Vector3f> LineOf(const Trajectory& trajectory, const Eigen::Vector3d& origin) {
  std::vector<Eigen::Vector3f> points;
  std::optional<Eigen::Vector3d> last;
  for (const TrajectoryState& state : trajectory.states()) {
    const Eigen::Vector3d& position = state.world_from_body.translation;
    if (last && (position - *last).norm() < kMinLineStep) continue;
    points.push_back(GltfFromSite(Eigen::Vector3f((position - origin).cast<float>())));
    last = position;
  }
  return points;
}

void AddGround(GltfBuilder& builder, const TriangleMesh& mesh, const GroundTexture& texture,
               MeshEncoding encoding, std::optional<int> parent) {
  std::vector<GltfPiece> pieces;
  for (const TextureChart& chart : texture.charts) {
    pieces.push_back({MakeGltfGeometry(mesh, chart, texture.texel_size),
                      builder.AddTexturedMaterial("ground", EncodeTextureJpeg(chart))});
    texture.Release();
  }
  if (texture.empty() && !mesh.empty())
    pieces.push_back(
        {MakeGltfGeometry(mesh), builder.AddMaterial("ground", Eigen::Vector3d::Ones())});
  builder.AddNode("ground", parent, GltfFromSite(mesh.origin),
                  builder.AddTriangles("ground", pieces, encoding));
}

void AddDrive(GltfBuilder& builder, const SiteDrive& drive, const Eigen::Vector3d& color,
              int parent) {
  const Trajectory& trajectory = drive.site_from_body_trajectory;
  const TimeSpan span = trajectory.span();
  nlohmann::json extras = {{"drive", drive.name}, {"length_m", trajectory.Length()}};
  if (!span.IsEmpty()) {
    extras["begin_s"] =
        ToDecimalSeconds(span.begin);  // text: a double cannot hold every nanosecond
    extras["end_s"] = ToDecimalSeconds(span.end);
  }
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (!trajectory.empty())
    origin = trajectory.states().front().world_from_body.translation.array().round();
  const std::vector<Eigen::Vector3f> line = LineOf(trajectory, origin);
  std::optional<int> mesh;
  if (line.size() >= 2) {
    const int material = builder.AddMaterial("drive:" + drive.name, color);
    mesh = builder.AddLineStrip("drive:" + drive.name, line, material);
  }
  builder.AddNode("drive:" + drive.name, parent, GltfFromSite(origin), mesh, extras);
}

}  // namespace

void WriteGltf(const SiteMap& map, MeshEncoding encoding, std::ostream& stream) {
  GltfBuilder builder;
  const nlohmann::json frames = DescribeFrames(map.datum);
  builder.SetAssetExtras(frames);
  const int site = builder.AddNode("site", {}, Eigen::Vector3d::Zero(), {}, frames);
  AddGround(builder, map.mesh, map.texture, encoding, site);
  for (size_t i = 0; i < map.drives.size(); ++i)
    AddDrive(builder, map.drives[i], kDriveColors[i % std::size(kDriveColors)], site);
  builder.Write(stream);
}

std::string EncodeGltfTile(const TriangleMesh& mesh, const GroundTexture& texture) {
  GltfBuilder builder;
  AddGround(builder, mesh, texture, MeshEncoding::kDraco, {});
  std::ostringstream stream;
  builder.Write(stream);
  return std::move(stream).str();
}

std::vector<double> ColumnMajor(const Rigid3& motion) {
  const Eigen::Matrix4d matrix = motion.Matrix();
  return {matrix.data(), matrix.data() + matrix.size()};
}

nlohmann::json DescribeFrames(const std::optional<SiteDatum>& datum) {
  Rigid3 gltf_from_site;
  gltf_from_site.rotation = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX());
  std::vector<double> matrix = ColumnMajor(gltf_from_site);
  for (double& entry : matrix)
    entry = std::round(entry) + 0.0;  // a quarter turn has no fractions, and no -0
  nlohmann::json frames = {{"frame", "site"}, {"units", "m"}, {"gltf_from_site", matrix}};
  if (datum) {
    frames["datum"] = {{"latitude_deg", datum->latitude_deg},
                       {"longitude_deg", datum->longitude_deg},
                       {"altitude", datum->altitude}};
    frames["georeference"] = {
        {"crs", "EPSG:4979"},
        {"origin", {datum->latitude_deg, datum->longitude_deg, datum->altitude}},
        {"frame", "ENU"},
        {"axes", "x=E,y=U,z=-N"},
        {"earth_from_site", ColumnMajor(EarthFromSite(*datum))}};
  }
  return frames;
}

}  // namespace parkade

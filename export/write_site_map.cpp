#include "export/write_site_map.h"

#include <cerrno>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/files/file.h"
#include "core/geoid.h"
#include "core/log.h"
#include "export/covariance_file.h"
#include "export/free_space.h"
#include "export/gltf/gltf.h"
#include "export/gltf/tiles.h"
#include "export/markings.h"
#include "export/ortho.h"
#include "export/ply.h"
#include "export/surface_parts.h"
#include "export/trajectory_files.h"

namespace parkade {
namespace {

using std::filesystem::path;

/// A drive's name becomes a folder's: no way out, and no clash with our own.
void ValidateNames(const std::vector<SiteDrive>& drives) {
  std::set<std::string> names = {"tiles"};
  for (const SiteDrive& drive : drives) {
    const auto is_allowed = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             c == '-' || c == '_' || c == '.';
    };
    const bool is_name = !drive.name.empty() && drive.name.front() != '.' &&
                         std::all_of(drive.name.begin(), drive.name.end(), is_allowed);
    Require(is_name, ErrorCode::kInternal, "'" + drive.name + "' cannot be the name of a drive");
    Require(names.insert(drive.name).second, ErrorCode::kInternal,
            "the name '" + drive.name + "' is taken");
  }
}

void WriteDrive(const SiteDrive& drive, const SiteMap& map, const std::optional<Geoid>& geoid,
                const path& folder) {
  std::filesystem::create_directories(folder);
  WriteTum(SampleOdometry(drive), folder / "odometry.tum");
  WriteTum(SampleFinalTrajectory(drive), folder / "trajectory.tum");
  WriteFileAtomically(folder / "covariance.csv", EncodeCovarianceCsv(drive, map.placement));
  if (!map.datum) return;
  WriteFileAtomically(folder / "trajectory.geojson", EncodeTrajectoryGeoJson(drive, *map.datum));
  WriteFileAtomically(folder / "trajectory.kml", EncodeTrajectoryKml(drive, *map.datum, geoid));
}

void WriteGlb(const SiteMap& map, MeshEncoding encoding, const path& file) {
  WriteFileAtomically(file, [&](const path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    WriteGltf(map, encoding, stream);
    stream.close();
    Require(!stream.fail(), errno == ENOSPC ? ErrorCode::kDiskFull : ErrorCode::kInternal,
            "cannot write '" + file.filename().string() + "'");
  });
}

void WriteGeoJson(const SiteMap& map, const path& folder) {
  const std::vector<FreeSheet> sheets = FindFreeSheets(map.surface);
  std::vector<std::string> drives;
  for (const SiteDrive& drive : map.drives) drives.push_back(drive.name);
  WriteFileAtomically(folder / "free_space.geojson", EncodeFreeSpaceGeoJson(sheets, map.datum));
  WriteFileAtomically(folder / "surfaces.geojson",
                      EncodeSurfacesGeoJson(FindSurfaceParts(map.surface), sheets, map.datum));
  WriteFileAtomically(folder / "slots.geojson",
                      EncodeSlotsGeoJson(map.markings.slots, drives, sheets, map.datum));
  WriteFileAtomically(folder / "markings.geojson",
                      EncodeMarkingsGeoJson(map.markings, sheets, map.datum));
}

}  // namespace

void WriteSiteMap(const SiteMap& map, const path& folder) {
  ValidateNames(map.drives);
  ValidateMesh(map.mesh);
  const std::optional<Geoid> geoid = map.datum ? Geoid::Find() : std::nullopt;
  for (const SiteDrive& drive : map.drives) WriteDrive(drive, map, geoid, folder / drive.name);

  WriteGlb(map, MeshEncoding::kDraco, folder / "map.glb");
  WriteGlb(map, MeshEncoding::kPlain, folder / "map_plain.glb");
  WriteFileAtomically(folder / "ground.ply", EncodePly(map.mesh));
  WriteGeoJson(map, folder);
  const Orthophoto ortho =
      map.texture.empty() ? RenderOrthophoto(map.surface) : RenderOrthophoto(map.mesh, map.texture);
  WriteFileAtomically(folder / "ortho.png", EncodePng(ortho));
  WriteFileAtomically(folder / "ortho.pgw", EncodeWorldFile(ortho));
  if (map.datum) WriteFileAtomically(folder / "ortho.tif", EncodeGeoTiff(ortho, *map.datum));
  std::filesystem::create_directories(folder / "tiles");
  EncodeTiles(map, [&](const std::string& name, const std::string& bytes) {
    WriteFileAtomically(folder / name, bytes);
  });
  LogInfo("stage=export drives=" + std::to_string(map.drives.size()) +
          " triangles=" + std::to_string(map.mesh.triangles.size()));
}

}  // namespace parkade

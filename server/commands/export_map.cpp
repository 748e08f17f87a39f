#include "server/commands/export_map.h"

#include <functional>

#include "core/error.h"
#include "core/files/file.h"
#include "core/trajectory.h"
#include "export/lanelet2/lanelet2_map.h"
#include "export/map_projector.h"
#include "export/point_cloud.h"
#include "export/pose_files.h"
#include "server/map_folder/kerbs_file.h"
#include "server/map_folder/output_folder.h"
#include "server/map_folder/overwrite_guard.h"
#include "server/map_folder/slots_file.h"

namespace parkade {
namespace {

using std::filesystem::path;

struct Exporter {
  ExportFormat format;
  std::function<void(const MapReader&, const path& out, const ExportOptions&)> write;
};

void CopyFile(const path& from, const path& to) {
  WriteFileAtomically(to, [&](const path& temporary) { CopyToWrite(from, temporary); });
}

/// A format that is one of the map's own files.
Exporter Copy(const std::string& name, const std::string& file, const std::string& description) {
  return {{name, description}, [file](const MapReader& map, const path& out, const ExportOptions&) {
            CopyFile(map.FileNamed(file), out);
          }};
}

Exporter CopyOfDrive(const std::string& name, const std::string& file,
                     const std::string& description) {
  return {{name, description},
          [file](const MapReader& map, const path& out, const ExportOptions& options) {
            CopyFile(map.FileOfDrive(options.drive, file), out);
          }};
}

/// A format made from the poses of a drive.
Exporter FromPoses(const std::string& name, std::string (*encode)(std::span<const TimedPose>),
                   const std::string& description) {
  return {{name, description},
          [encode](const MapReader& map, const path& out, const ExportOptions& options) {
            WriteFileAtomically(out,
                                encode(ReadTum(map.FileOfDrive(options.drive, "trajectory.tum"))));
          }};
}

void WritePcd(const MapReader& map, const path& out, const ExportOptions& options) {
  Require(options.spacing > 0, ErrorCode::kUsage, "the spacing of a point cloud must be > 0 m");
  WriteFileAtomically(out, EncodePcd(SamplePoints(map.ReadGround(), options.spacing)));
}

/// The files of a map folder of Autoware that say where the ground is.
void StageAutoware(const MapReader& map, const path& staging, const ExportOptions& options) {
  WritePcd(map, staging / "pointcloud_map.pcd", options);
  WriteFileAtomically(staging / "map_projector_info.yaml", MapProjector(map.datum()).EncodeInfo());
}

void WriteAutoware(const MapReader& map, const path& out, const ExportOptions& options) {
  OutputFolder folder(out);
  StageAutoware(map, folder.staging(), options);
  folder.Commit();
}

ParkingMap ReadParkingMap(const MapReader& map) {
  const SurfaceMap surface = map.ReadSurfaceMap();
  ParkingMap parking{.sheets = FindFreeSheets(surface), .cell_size = surface.cell_size};
  for (StoredSlot& stored : ReadSlots(map.FileNamed("slots.geojson"), map.datum()))
    parking.slots.push_back({std::move(stored.id), std::move(stored.slot)});
  parking.kerbs = ReadKerbs(map.FileNamed("markings.geojson"));
  return parking;
}

void WriteLanelet2(const MapReader& map, const path& out, const ExportOptions& options) {
  const std::string osm = EncodeLanelet2(ReadParkingMap(map), map.datum(), options.level);
  OutputFolder folder(out);
  WriteFileAtomically(folder.staging() / "lanelet2_map.osm", osm);
  StageAutoware(map, folder.staging(), options);
  folder.Commit();
}

void WriteOccupancy(const MapReader& map, const path& out, const ExportOptions& options) {
  path image = out;
  image.replace_extension(".pgm");
  Require(image != out, ErrorCode::kUsage,
          "--out names the description, FILE.yaml; FILE.pgm goes beside it");
  const OccupancyGrid grid =
      MakeOccupancyGrid(map.ReadGround(), image.filename().string(), options.grid);
  WriteFileAtomically(image, grid.pgm);
  WriteFileAtomically(out, grid.yaml);
}

void WriteTiles(const MapReader& map, const path& out, const ExportOptions&) {
  RequireOverwritable(out, {});
  OutputFolder folder(out);
  CopyFile(map.FileNamed("tileset.json"), folder.staging() / "tileset.json");
  std::filesystem::copy(map.FileNamed("tiles"), folder.staging() / "tiles");
  folder.Commit();
}

const std::vector<Exporter>& Exporters() {
  static const std::vector<Exporter> exporters = {
      Copy("glb", "map.glb", "glTF 2.0, compressed by Draco"),
      Copy("glb-plain", "map_plain.glb", "glTF 2.0"),
      {{"3d-tiles", "folder: 3D Tiles 1.1", /*is_folder=*/true}, WriteTiles},
      Copy("ply", "ground.ply", "the ground as a mesh, with colors and height sigma"),
      {{"pcd", "the ground as points (PCL)"}, WritePcd},
      {{"autoware", "folder: pointcloud_map.pcd and map_projector_info.yaml", /*is_folder=*/true},
       WriteAutoware},
      {{"lanelet2", "folder: the same and lanelet2_map.osm: slots, lots, obstacles, kerbs",
        /*is_folder=*/true},
       WriteLanelet2},
      {{"occupancy", "FILE.yaml and FILE.pgm for ROS' map_server"}, WriteOccupancy},
      Copy("geojson", "free_space.geojson", "outline of the free space"),
      Copy("surfaces", "surfaces.geojson", "what lies beside the free space, by class (GeoJSON)"),
      Copy("slots", "slots.geojson", "parking slots and who stood in them (GeoJSON)"),
      Copy("markings", "markings.geojson",
           "other paint on the ground, speed bumps, kerbs with heights (GeoJSON)"),
      Copy("png", "ortho.png", "orthophoto"),
      Copy("geotiff", "ortho.tif", "orthophoto on Earth"),
      CopyOfDrive("tum", "trajectory.tum", "trajectory: t x y z qx qy qz qw"),
      FromPoses("kitti", EncodeKittiPoses, "trajectory: 3 x 4 matrices"),
      FromPoses("euroc", EncodeEurocPoses, "trajectory: ASL's CSV"),
      CopyOfDrive("covariance", "covariance.csv", "how sure its poses are (CSV)"),
      CopyOfDrive("kml", "trajectory.kml", "trajectory on Earth"),
      CopyOfDrive("trajectory-geojson", "trajectory.geojson", "trajectory on Earth"),
  };
  return exporters;
}

}  // namespace

const std::vector<ExportFormat>& ExportFormats() {
  static const std::vector<ExportFormat> formats = [] {
    std::vector<ExportFormat> list;
    for (const Exporter& exporter : Exporters()) list.push_back(exporter.format);
    return list;
  }();
  return formats;
}

void ExportMap(const MapReader& map, const std::string& format, const path& out,
               const ExportOptions& options) {
  const path plain = out.has_filename() ? out : out.parent_path();  // "folder/"
  const path folder = std::filesystem::absolute(plain).lexically_normal().parent_path();
  RequireWritable(folder);
  std::string known;
  for (const Exporter& exporter : Exporters()) {
    if (exporter.format.name == format) {
      Require(exporter.format.is_folder || !std::filesystem::is_directory(plain),
              ErrorCode::kInvalidInput,
              "'" + plain.string() + "' is a folder, and " + format + " is a file");
      return exporter.write(map, plain, options);
    }
    known += (known.empty() ? "" : ", ") + exporter.format.name;
  }
  throw Error(ErrorCode::kUsage, "there is no format '" + format + "', but: " + known);
}

}  // namespace parkade

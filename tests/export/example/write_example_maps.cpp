// Writes the maps that read_maps.mjs reads:
// FOLDER/{georeferenced,local,textured,without_ground,no_manifold,empty}; and those that
// read_lanelet2.py reads: FOLDER/parking_{local,georeferenced}, with lanelet2/ in them.

#include <cstdio>

#include "core/files/file.h"
#include "core/log.h"
#include "export/gltf/gltf.h"
#include "export/gltf/move_gltf.h"
#include "export/lanelet2/lanelet2_map.h"
#include "export/map_projector.h"
#include "export/write_site_map.h"
#include "tests/export/example_map.h"
#include "tests/export/lanelet2/parking_example.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  parkade::SetLogLevel(parkade::LogLevel::kWarning);
  const std::filesystem::path root = argv[1];
  std::filesystem::remove_all(root);
  const auto write = [&](const char* name, const parkade::SiteMap& map) {
    std::filesystem::create_directories(root / name);
    parkade::WriteSiteMap(map, root / name);
  };
  write("georeferenced", parkade::MakeExampleMap(true));
  write("local", parkade::MakeExampleMap(false));
  write("textured", parkade::MakeTexturedMap());
  write("without_ground", parkade::MakeMapWithoutGround());
  write("no_manifold", parkade::MakeMapOfNoManifold());
  write("empty", {});
  for (const bool is_georeferenced : {false, true}) {
    const char* name = is_georeferenced ? "parking_georeferenced" : "parking_local";
    const parkade::SiteMap map = parkade::MakeParkingExample(is_georeferenced);
    write(name, map);
    const std::filesystem::path folder = root / name / "lanelet2";
    std::filesystem::create_directories(folder);
    parkade::WriteFileAtomically(folder / "lanelet2_map.osm",
                                 EncodeLanelet2(parkade::ParkingMapOf(map), map.datum));
    parkade::WriteFileAtomically(folder / "map_projector_info.yaml",
                                 parkade::MapProjector(map.datum).EncodeInfo());
  }
  const parkade::PointMotion bend =
      [](const Eigen::Vector3d& point) -> std::optional<Eigen::Vector3d> {
    if (point.y() > 8) return std::nullopt;
    return point + Eigen::Vector3d(100, 0.001 * point.x() * point.x(), 0);
  };
  parkade::WriteFileAtomically(
      root / "moved.glb",
      parkade::MoveGltf(EncodeGltf(parkade::MakeTexturedMap(), parkade::MeshEncoding::kPlain), bend,
                        {}, {}));
}

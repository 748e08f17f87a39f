// Writes the maps that read_maps.mjs reads:
// FOLDER/{georeferenced,local,textured,without_ground,no_manifold,empty}.

#include <cstdio>

#include "core/file.h"
#include "core/log.h"
#include "export/gltf/gltf.h"
#include "export/gltf/move_gltf.h"
#include "export/write_site_map.h"
#include "tests/export/example_map.h"

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

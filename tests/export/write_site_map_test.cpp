#include "export/write_site_map.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <map>

#include "core/error.h"
#include "core/files/file.h"
#include "tests/export/example_map.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class MapFolder : public testing::Test {
 protected:
  MapFolder() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~MapFolder() override { fs::remove_all(folder_); }

  std::map<std::string, std::string> Files() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.is_regular_file())
        files[fs::relative(entry.path(), folder_)] = ReadFile(entry.path());
    return files;
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("map_" + std::to_string(::getpid()));
};

TEST_F(MapFolder, HoldsEveryFileOfTheContractAndNothingElse) {
  WriteSiteMap(MakeExampleMap(true), folder_);

  auto files = Files();
  for (const char* name : {"map.glb",
                           "map_plain.glb",
                           "tileset.json",
                           "tiles/overview.glb",
                           "ground.ply",
                           "free_space.geojson",
                           "slots.geojson",
                           "surfaces.geojson",
                           "markings.geojson",
                           "ortho.png",
                           "ortho.pgw",
                           "ortho.tif",
                           "monday/odometry.tum",
                           "monday/trajectory.tum",
                           "monday/trajectory.geojson",
                           "monday/trajectory.kml",
                           "monday/covariance.csv",
                           "tuesday_2/covariance.csv",
                           "tuesday_2/odometry.tum",
                           "tuesday_2/trajectory.tum",
                           "tuesday_2/trajectory.geojson",
                           "tuesday_2/trajectory.kml"})
    EXPECT_EQ(files.erase(name), 1U) << name;
  std::erase_if(files, [](const auto& file) { return file.first.starts_with("tiles/"); });
  EXPECT_TRUE(files.empty()) << files.begin()->first;
}

TEST_F(MapFolder, WrittenAgainIsTheSameToTheByte) {
  WriteSiteMap(MakeExampleMap(true), folder_);
  const auto first = Files();
  WriteSiteMap(MakeExampleMap(true), folder_);
  EXPECT_EQ(Files(), first);
}

TEST_F(MapFolder, WithoutADatumNothingClaimsToBeOnTheGlobe) {
  WriteSiteMap(MakeExampleMap(false), folder_);

  const auto files = Files();
  EXPECT_FALSE(files.contains("monday/trajectory.geojson"));
  EXPECT_FALSE(files.contains("monday/trajectory.kml"));
  EXPECT_EQ(files.at("tileset.json").find("transform"), std::string::npos);
  EXPECT_EQ(files.at("map.glb").find("georeference"), std::string::npos);
}

TEST_F(MapFolder, TrajectoriesAreReadableTum) {
  WriteSiteMap(MakeMapWithoutGround(), folder_);
  EXPECT_EQ(ReadTum(folder_ / "monday" / "odometry.tum").size(), 3000U);
  EXPECT_GE(ReadTum(folder_ / "monday" / "trajectory.tum").size(), 600U);
}

TEST_F(MapFolder, NamesThatLeaveTheFolderOrClashAreRefused) {
  for (const char* name : {"", "..", ".hidden", "a/b", "tiles", "tuesday_2"}) {
    SiteMap map = MakeMapWithoutGround();
    map.drives[0].name = name;
    EXPECT_THROW(WriteSiteMap(map, folder_), Error) << "'" << name << "'";
  }
  EXPECT_TRUE(Files().empty());
}

TEST_F(MapFolder, ABrokenMeshIsRefusedBeforeAnythingIsWritten) {
  SiteMap map = MakeExampleMap(false);
  map.mesh.triangles[0][1] = 1'000'000;
  EXPECT_THROW(WriteSiteMap(map, folder_), Error);
  EXPECT_TRUE(Files().empty());
}

}  // namespace
}  // namespace parkade

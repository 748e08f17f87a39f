// Holds the arrows between folders: reads every #include of the tree.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace parkade {
namespace {

namespace fs = std::filesystem;

using Includes = std::map<std::string, std::set<std::string>>;  // file -> what it includes

/// One arrow: files below `folder` may include project files below `allowed`.
struct FolderRule {
  std::string folder;
  std::vector<std::string> allowed;
};

// The first rule whose folder matches counts.
const std::vector<FolderRule> kFolderRules = {
    {"core/", {"core/"}},
    {"slam/", {"core/", "slam/"}},
    {"mapping/", {"core/", "mapping/"}},
    {"export/", {"core/", "export/"}},
    {"server/ingest/", {"core/", "server/ingest/"}},
    {"server/store/", {"core/", "server/store/"}},
    {"server/jobs/", {"core/", "server/store/", "server/jobs/"}},
    {"server/webhooks/", {"core/", "server/store/", "server/webhooks/"}},
    {"server/http/",
     {"core/", "server/store/", "server/jobs/", "server/webhooks/", "server/http/"}},
    {"server/", {"core/", "slam/", "mapping/", "export/", "server/"}},
    {"tests/simulator/tracks/", {"core/", "slam/", "tests/simulator/"}},
    {"tests/simulator/", {"core/", "server/ingest/writing/", "tests/support/", "tests/simulator/"}},
};

// The rooms of each folder, from the lowest to the highest: a file includes its own room and those
// before it.
const std::vector<std::string> kRooms = {
    "core/error.h",
    "core/math/",
    "core/files/",
    "core/",
    "core/calibration/",
    "slam/tracking/",
    "slam/schur/",
    "slam/factors/",
    "slam/initialization/",
    "slam/smoother/",
    "slam/odometry/",
    "slam/georeference/",
    "slam/pose_graph/",
    "slam/places/",
    "slam/baselines/",
    "slam/loops/",
    "slam/refinement/",
    "slam/sessions/",
    "slam/evaluation/",
    "mapping/ground/",
    "mapping/networks/",
    "mapping/baselines/",
    "mapping/observation/",
    "mapping/heights/",
    "mapping/surface/",
    "mapping/mesh/",
    "mapping/texture/",
    "mapping/kerbs/",
    "mapping/roadside/",
    "mapping/markings/",
    "mapping/evaluation/",
    "export/gltf/",
    "export/",
    "export/lanelet2/",
    "server/ingest/files/",
    "server/ingest/writing/",
    "server/ingest/containers/",
    "server/ingest/messages/",
    "server/ingest/video/",
    "server/ingest/schemas/",
    "server/ingest/checks/",
    "server/ingest/drive/",
    "server/ingest/conversion/",
    "server/ingest/inspection/",
    "server/ingest/pictures/",
    "server/store/disk/",
    "server/store/tables/",
    "server/store/access/",
    "server/store/",
    "server/store/uploads/",
    "server/store/care/",
    "server/store/review/",
    "server/jobs/walls/",
    "server/jobs/",
    "server/jobs/pictures/",
    "server/jobs/slurm/",
    "server/webhooks/",
    "server/http/trace/",
    "server/http/",
    "server/http/access/",
    "server/http/routes/",
    "server/http/service/",
    "server/map_folder/",
    "server/compare/",
    "server/findings/",
    "server/pipeline/",
    "server/commands/",
    "server/main.cpp",
    "tests/simulator/common/",
    "tests/simulator/motion/",
    "tests/simulator/vehicle/",
    "tests/simulator/rays/",
    "tests/simulator/ground/",
    "tests/simulator/layouts/",
    "tests/simulator/scenes/",
    "tests/simulator/render/",
    "tests/simulator/sensors/",
    "tests/simulator/sinks/",
    "tests/simulator/faults/",
    "tests/simulator/drives/",
    "tests/simulator/tracks/",
    "tests/simulator/main.cpp",
};
constexpr size_t kMaxFilesPerRoom = 45;

/// A heavy library and the only places that may see it, directly or through a header.
struct WallRule {
  std::string header_prefix;
  std::vector<std::string> allowed;
};

const std::vector<WallRule> kWallRules = {
    {"ceres/", {"slam/"}},
    {"pcl/", {"mapping/"}},
    {"CGAL/", {"mapping/"}},
    {"opencv2/dnn", {"mapping/"}},
    {"tiny_gltf", {"export/"}},
    {"draco/", {"export/"}},
    {"pugixml", {"export/"}},
    {"httplib.h", {"server/http/"}},
    {"curl/", {"server/webhooks/"}},
    {"sqlite3.h", {"server/ingest/", "server/store/"}},
    {"archive", {"server/ingest/", "server/store/"}},
    {"zstd.h",
     {"server/ingest/", "server/map_folder/surface_file", "server/map_folder/ground_codec"}},
    {"lz4", {"server/ingest/"}},
    {"bzlib.h", {"server/ingest/"}},
    {"fastcdr/", {"server/ingest/"}},
    {"jpeglib.h", {"server/ingest/"}},
    {"turbojpeg.h", {"server/ingest/"}},
    {"libav", {"server/ingest/video/video_decoder.cpp"}},
    {"libswscale/", {"server/ingest/video/video_decoder.cpp"}},
    {"GeographicLib/", {"core/geo.cpp", "core/geoid.cpp"}},
    {"yaml-cpp/", {"core/", "server/"}},
    {"embree", {"tests/simulator/"}},
    {"gtest/", {}},
    {"tests/", {"tests/"}},
};

/// The place of a file's room among kRooms: that of the longest name that fits; nothing without
/// one.
std::optional<size_t> FindRoom(const std::string& file) {
  std::optional<size_t> found;
  for (size_t i = 0; i < kRooms.size(); ++i)
    if (file.starts_with(kRooms[i]) && (!found || kRooms[i].size() > kRooms[*found].size()))
      found = i;
  return found;
}

/// "slam/factors/imu_cost" of its header and its source.
std::string UnitOf(const std::string& file) { return file.substr(0, file.rfind('.')); }

bool StartsWithAny(const std::string& text, const std::vector<std::string>& prefixes) {
  for (const std::string& prefix : prefixes)
    if (text.starts_with(prefix)) return true;
  return false;
}

Includes ReadIncludes(const fs::path& root) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  Includes includes;
  for (const char* folder : {"core", "slam", "mapping", "export", "server", "tests/simulator"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if ((extension != ".h" && extension != ".cpp") ||
          entry.path().stem().string().ends_with("_test"))
        continue;
      std::set<std::string>& found = includes[fs::relative(entry.path(), root).generic_string()];
      std::ifstream file(entry.path());
      std::smatch match;
      for (std::string line; std::getline(file, line);)
        if (std::regex_search(line, match, kInclude)) found.insert(match[1]);
    }
  }
  return includes;
}

/// Everything that `file` sees, through project headers too.
void CollectReachable(const Includes& includes, const std::string& file,
                      std::set<std::string>& reachable) {
  const auto found = includes.find(file);
  if (found == includes.end()) return;
  for (const std::string& included : found->second)
    if (reachable.insert(included).second) CollectReachable(includes, included, reachable);
}

/// Includes among units: a header with its source.
using Units = std::map<std::string, std::set<std::string>>;

Units UnitsOf(const Includes& includes) {
  Units units;
  for (const auto& [file, included] : includes)
    for (const std::string& header : included)
      if (includes.contains(header) && UnitOf(header) != UnitOf(file))
        units[UnitOf(file)].insert(UnitOf(header));
  return units;
}

/// Follows includes from `unit`; where they come back to one of `way`, that part of the way is the
/// cycle.
std::vector<std::string> FindCycle(const Units& units, const std::string& unit,
                                   std::vector<std::string>& way, std::set<std::string>& done) {
  if (const auto begin = std::find(way.begin(), way.end(), unit); begin != way.end())
    return {begin, way.end()};
  if (!done.insert(unit).second) return {};
  way.push_back(unit);
  if (const auto found = units.find(unit); found != units.end())
    for (const std::string& next : found->second)
      if (std::vector<std::string> cycle = FindCycle(units, next, way, done); !cycle.empty())
        return cycle;
  way.pop_back();
  return {};
}

class Architecture : public testing::Test {
 protected:
  const fs::path root_ = PARKADE_SOURCE_DIR;
  const Includes includes_ = ReadIncludes(root_);
};

TEST_F(Architecture, TheTreeWasRead) {
  EXPECT_GT(includes_.size(), 40u);
  EXPECT_TRUE(includes_.contains("core/rig.h"));
}

TEST_F(Architecture, LinesGoDownBetweenFolders) {
  for (const auto& [file, included] : includes_) {
    const auto rule = std::find_if(
        kFolderRules.begin(), kFolderRules.end(),
        [&](const FolderRule& candidate) { return file.starts_with(candidate.folder); });
    ASSERT_NE(rule, kFolderRules.end()) << file;
    for (const std::string& header : included) {
      const bool is_allowed = !includes_.contains(header) || StartsWithAny(header, rule->allowed);
      EXPECT_TRUE(is_allowed) << file << " includes " << header;
    }
  }
}

TEST_F(Architecture, LinesGoDownBetweenRooms) {
  const auto folder_of = [](size_t room) { return kRooms[room].substr(0, kRooms[room].find('/')); };
  for (const auto& [file, included] : includes_) {
    const std::optional<size_t> room = FindRoom(file);
    ASSERT_TRUE(room) << file << " is in no room";
    for (const std::string& header : included) {
      const std::optional<size_t> other =
          includes_.contains(header) ? FindRoom(header) : std::nullopt;
      if (other && folder_of(*other) == folder_of(*room)) {
        EXPECT_LE(*other, *room) << file << " includes " << header;
      }
    }
  }
}

TEST_F(Architecture, RoomsAreSmallEnoughToKnow) {
  std::map<std::string, size_t> counts;
  for (const auto& [file, included] : includes_) ++counts[kRooms[FindRoom(file).value()]];
  for (const auto& [room, count] : counts) EXPECT_LE(count, kMaxFilesPerRoom) << room;
}

TEST_F(Architecture, UnitsDoNotIncludeEachOther) {
  const Units units = UnitsOf(includes_);
  ASSERT_GT(units.size(), 40u);
  std::set<std::string> done;
  for (const auto& [unit, included] : units) {
    std::vector<std::string> way;
    EXPECT_EQ(FindCycle(units, unit, way, done), std::vector<std::string>{}) << "from " << unit;
  }
}

TEST_F(Architecture, HeavyLibrariesStayBehindTheirWalls) {
  for (const auto& [file, included] : includes_) {
    std::set<std::string> reachable;
    CollectReachable(includes_, file, reachable);
    for (const std::string& header : reachable) {
      for (const WallRule& wall : kWallRules) {
        const bool is_allowed =
            !header.starts_with(wall.header_prefix) || StartsWithAny(file, wall.allowed);
        EXPECT_TRUE(is_allowed) << file << " sees " << header;
      }
    }
  }
}

}  // namespace
}  // namespace parkade

// Holds the arrows between folders: reads every #include of the tree.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
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
    {"server/http/", {"core/", "server/store/", "server/jobs/", "server/http/"}},
    {"server/", {"core/", "slam/", "mapping/", "export/", "server/"}},
};

/// A heavy library and the only places that may see it, directly or through a header.
struct WallRule {
  std::string header_prefix;
  std::vector<std::string> allowed;
};

const std::vector<WallRule> kWallRules = {
    {"ceres/", {"slam/"}},
    {"opengv/", {"slam/"}},
    {"pcl/", {"mapping/"}},
    {"CGAL/", {"mapping/"}},
    {"opencv2/dnn", {"mapping/"}},
    {"tiny_gltf", {"export/"}},
    {"draco/", {"export/"}},
    {"httplib.h", {"server/http/"}},
    {"sqlite3.h", {"server/ingest/", "server/store/"}},
    {"archive", {"server/ingest/", "server/store/"}},
    {"zstd.h", {"server/ingest/", "server/surface_file", "server/ground_codec"}},
    {"lz4", {"server/ingest/"}},
    {"bzlib.h", {"server/ingest/"}},
    {"fastcdr/", {"server/ingest/"}},
    {"jpeglib.h", {"server/ingest/"}},
    {"turbojpeg.h", {"server/ingest/"}},
    {"GeographicLib/", {"core/geo.cpp", "core/geoid.cpp"}},
    {"yaml-cpp/", {"core/", "server/"}},
    {"embree", {}},
    {"gtest/", {}},
    {"tests/", {}},
};

bool StartsWithAny(const std::string& text, const std::vector<std::string>& prefixes) {
  for (const std::string& prefix : prefixes)
    if (text.starts_with(prefix)) return true;
  return false;
}

Includes ReadIncludes(const fs::path& root) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  Includes includes;
  for (const char* folder : {"core", "slam", "mapping", "export", "server"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
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
void CollectReachable(const Includes& includes, const std::string& file, std::set<std::string>& reachable) {
  const auto found = includes.find(file);
  if (found == includes.end()) return;
  for (const std::string& included : found->second)
    if (reachable.insert(included).second) CollectReachable(includes, included, reachable);
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
    const auto rule = std::find_if(kFolderRules.begin(), kFolderRules.end(),
                                   [&](const FolderRule& candidate) { return file.starts_with(candidate.folder); });
    ASSERT_NE(rule, kFolderRules.end()) << file;
    for (const std::string& header : included) {
      const bool is_allowed = !includes_.contains(header) || StartsWithAny(header, rule->allowed);
      EXPECT_TRUE(is_allowed) << file << " includes " << header;
    }
  }
}

TEST_F(Architecture, HeavyLibrariesStayBehindTheirWalls) {
  for (const auto& [file, included] : includes_) {
    std::set<std::string> reachable;
    CollectReachable(includes_, file, reachable);
    for (const std::string& header : reachable) {
      for (const WallRule& wall : kWallRules) {
        const bool is_allowed = !header.starts_with(wall.header_prefix) || StartsWithAny(file, wall.allowed);
        EXPECT_TRUE(is_allowed) << file << " sees " << header;
      }
    }
  }
}

}  // namespace
}  // namespace parkade

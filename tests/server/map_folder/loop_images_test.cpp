#include "server/map_folder/loop_images.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "core/files/file.h"
#include "tests/server/store/temporary_root.h"

namespace parkade {
namespace {

TEST(LoopImages, TheReportNamesTheFilesThatAreWritten) {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].name = "front", rig.cameras[1].name = "rear";
  LoopClosure closure;
  closure.loops.resize(3);
  closure.loops[0].earlier_keyframe = 3, closure.loops[0].later_keyframe = 17;
  closure.loops[1].earlier_keyframe = 3, closure.loops[1].later_keyframe = 18;
  closure.loops[1].later_camera = 1;
  closure.loops[2].earlier_keyframe = 4, closure.loops[2].later_keyframe = 19;
  closure.views = {{{3, 0}, "jpeg of 3"}, {{17, 0}, "jpeg of 17"}, {{18, 1}, "jpeg of 18"}};
  const TemporaryRoot root;

  WriteLoopImages(closure, rig, "monday", root.path());
  const nlohmann::json json = LoopsToJson(closure, rig, "monday");

  std::set<std::string> named;
  for (const nlohmann::json& loop : json["candidates"])
    for (const nlohmann::json& image : loop["thumbnails"]) named.insert(image.get<std::string>());
  EXPECT_EQ(json["candidates"][1]["thumbnails"],
            nlohmann::json({"monday/loops/00003-front.jpg", "monday/loops/00018-rear.jpg"}));
  EXPECT_TRUE(json["candidates"][2]["thumbnails"].empty()) << "nobody saw anything there";
  std::set<std::string> written;
  for (const auto& file : std::filesystem::directory_iterator(root.path() / "monday/loops"))
    written.insert("monday/loops/" + file.path().filename().string());
  EXPECT_EQ(written, named);
  EXPECT_EQ(ReadFile(root.path() / "monday/loops/00018-rear.jpg", 100), "jpeg of 18");
}

}  // namespace
}  // namespace parkade

#include "server/map_folder/loop_images.h"

#include <cstdio>
#include <utility>

#include "core/files/file.h"

namespace parkade {
namespace {

/// The image's path, relative to the map's folder.
std::string ImageName(const std::string& drive, size_t keyframe, const std::string& camera) {
  char number[16];
  std::snprintf(number, sizeof number, "%05zu", keyframe);
  return drive + "/loops/" + number + "-" + camera + ".jpg";
}

const std::string& NameOf(const Rig& rig, int camera) {
  return rig.cameras[static_cast<size_t>(camera)].name;
}

}  // namespace

nlohmann::json LoopsToJson(const LoopClosure& closure, const Rig& rig, const std::string& drive) {
  nlohmann::json json = ToJson(closure);
  for (size_t i = 0; i < closure.loops.size(); ++i) {
    const LoopEvidence& loop = closure.loops[i];
    nlohmann::json& of_loop = json["candidates"][i];
    for (nlohmann::json& pair : of_loop["camera_pairs"])
      for (const char* end : {"earlier", "later"}) pair[end] = NameOf(rig, pair[end].get<int>());
    for (nlohmann::json& camera : of_loop["inliers"]["cameras"])
      camera = NameOf(rig, camera.get<int>());
    of_loop["thumbnails"] = nlohmann::json::array();
    for (const auto& end : {std::pair(loop.earlier_keyframe, loop.earlier_camera),
                            std::pair(loop.later_keyframe, loop.later_camera)})
      if (closure.views.contains(end))
        of_loop["thumbnails"].push_back(ImageName(drive, end.first, NameOf(rig, end.second)));
  }
  return json;
}

void WriteLoopImages(const LoopClosure& closure, const Rig& rig, const std::string& drive,
                     const std::filesystem::path& folder) {
  for (const auto& [end, jpeg] : closure.views) {
    const std::filesystem::path file =
        folder / ImageName(drive, end.first, NameOf(rig, end.second));
    std::filesystem::create_directories(file.parent_path());
    WriteFileAtomically(file, jpeg);
  }
}

}  // namespace parkade

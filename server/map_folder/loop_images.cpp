#include "server/map_folder/loop_images.h"

#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "core/files/file.h"

namespace parkade {
namespace {

constexpr int kQuality = 80;

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
    if (!loop.earlier_view.empty())
      of_loop["thumbnails"].push_back(
          ImageName(drive, loop.earlier_keyframe, NameOf(rig, loop.earlier_camera)));
    if (!loop.later_view.empty())
      of_loop["thumbnails"].push_back(
          ImageName(drive, loop.later_keyframe, NameOf(rig, loop.later_camera)));
  }
  return json;
}

void WriteLoopImages(const LoopClosure& closure, const Rig& rig, const std::string& drive,
                     const std::filesystem::path& folder) {
  std::set<std::string> written;
  const auto write = [&](const cv::Mat& view, size_t keyframe, int camera) {
    const std::string name = ImageName(drive, keyframe, NameOf(rig, camera));
    if (view.empty() || !written.insert(name).second) return;
    std::vector<uchar> jpeg;
    cv::imencode(".jpg", view, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
    std::filesystem::create_directories((folder / name).parent_path());
    WriteFileAtomically(folder / name,
                        std::string_view(reinterpret_cast<const char*>(jpeg.data()), jpeg.size()));
  };
  for (const LoopEvidence& loop : closure.loops) {
    write(loop.earlier_view, loop.earlier_keyframe, loop.earlier_camera);
    write(loop.later_view, loop.later_keyframe, loop.later_camera);
  }
}

}  // namespace parkade

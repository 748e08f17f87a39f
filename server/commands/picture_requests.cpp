#include "server/commands/picture_requests.h"

#include <algorithm>

#include "core/error.h"
#include "core/files/file.h"
#include "server/ingest/drive/open_drive_log.h"
#include "server/ingest/pictures/read_picture.h"
#include "server/ingest/schemas/mapped_source.h"
#include "server/ingest/schemas/translated_source.h"
#include "server/map_folder/map_reader.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

PictureIndex ReadOrMakeIndex(const std::shared_ptr<const MessageSource>& source,
                             const fs::path& rig_folder, const fs::path& file) {
  if (fs::exists(file)) {
    try {
      return DecodePictureIndex(ReadFile(file));
    } catch (const Error&) {
      // of an older program, or damaged: made anew
    }
  }
  Rig rig = FindRig(*source, rig_folder);
  const auto mapped = MapFields(source, rig);
  PictureIndex index = IndexPictures(*mapped, rig);
  WriteFileAtomically(file, EncodePictureIndex(index));
  return index;
}

}  // namespace

PictureRequests::PictureRequests(const fs::path& log, const fs::path& rig_folder,
                                 const fs::path& index)
    : rig_folder_(rig_folder),
      source_(OpenTranslatedLog(log, {})),
      index_(ReadOrMakeIndex(source_, rig_folder, index)) {}

Json PictureRequests::Answer(const Json& request) {
  return request.contains("point") ? FindViews(request) : WritePicture(request);
}

Json PictureRequests::WritePicture(const Json& request) const {
  const std::string name = request.at("camera");
  const auto camera =
      std::find_if(index_.cameras.begin(), index_.cameras.end(),
                   [&](const IndexedCamera& candidate) { return candidate.name == name; });
  Require(camera != index_.cameras.end(), ErrorCode::kNotFound, "the log has no camera " + name);
  const Timestamp time{request.at("time").get<std::int64_t>()};
  const auto image = std::lower_bound(
      camera->images.begin(), camera->images.end(), time,
      [](const IndexedImage& candidate, Timestamp t) { return candidate.time < t; });
  Require(image != camera->images.end() && image->time == time, ErrorCode::kNotFound,
          name + " has no image at " + ToDecimalSeconds(time));
  const Picture picture = ReadPicture(*source_, *camera, *image, request.at("width"));
  const Json sizes = {{"width", picture.width},
                      {"height", picture.height},
                      {"full_width", picture.full_width},
                      {"full_height", picture.full_height}};
  WriteFileAtomically(request.at("out").get<std::string>(), sizes.dump() + "\n" + picture.jpeg);
  return Json::object();
}

Json PictureRequests::FindViews(const Json& request) {
  const std::string map = request.at("map"), drive = request.at("drive");
  if (views_of_ != map + "/" + drive) views_ = ReadViews(map, drive);
  views_of_ = map + "/" + drive;
  const auto point = request.at("point").get<std::array<double, 3>>();
  Json views = Json::array();
  for (const PointView& view :
       FindPointViews({point[0], point[1], point[2]}, *views_, request.at("limit")))
    views.push_back({{"camera", view.camera},
                     {"time", ToDecimalSeconds(view.time)},
                     {"pixel", {view.pixel.x(), view.pixel.y()}},
                     {"distance", view.distance},
                     {"view_angle", view.view_angle},
                     {"resolution", view.resolution}});
  return {{"views", views}};
}

DriveViews PictureRequests::ReadViews(const fs::path& map, const std::string& drive) const {
  const MapReader reader(map);
  DriveViews views{.rig = ReadCalibration(reader.FileOfDrive(drive, "calibration.yaml")),
                   .site_from_imu = reader.ReadTrajectory(drive),
                   .cameras = {},
                   .surface = reader.ReadSurfaceMap()};
  const Rig given = rig_folder_.empty() ? Rig{} : ReadRig(rig_folder_);
  for (const IndexedCamera& camera : index_.cameras) {
    CameraTimes& times = views.cameras.emplace_back();
    times.name = camera.name;
    times.time_shift = camera.stream.time_shift;
    for (const IndexedImage& image : camera.images) times.times.push_back(image.time);
    for (const RigCamera& of_rig : given.cameras)
      if (of_rig.name == camera.name) times.mask = of_rig.mask;
  }
  return views;
}

}  // namespace parkade

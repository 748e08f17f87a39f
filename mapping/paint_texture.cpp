#include "mapping/paint_texture.h"

#include <numbers>

#include "core/error.h"
#include "core/log.h"
#include "core/parallel.h"
#include "mapping/chart_painter.h"
#include "mapping/keyframe_picker.h"

namespace parkade {
namespace {

constexpr std::size_t kPhotosPerBatch = 16;  // in memory at once

/// The next images of a drive with their poses, up to a batch; fewer only at the end.
std::vector<GroundPhoto> NextPhotos(RecordStream& stream, const TextureSource& source) {
  const DrivenPath& path = *source.path;
  std::vector<GroundPhoto> photos;
  while (photos.size() < kPhotosPerBatch) {
    std::optional<SensorRecord> record = stream.Next();
    if (!record) break;
    const auto* frame = std::get_if<CameraFrame>(&*record);
    const std::optional<Rigid3> site_from_body = frame ? path.site_from_body.At(frame->time) : std::nullopt;
    if (!site_from_body) continue;
    const RigCamera& camera = source.log->rig().cameras[static_cast<std::size_t>(frame->camera)];
    photos.push_back({.image = frame->image,
                      .camera = &camera,
                      .site_from_camera = *site_from_body * camera.body_from_camera,
                      .site_from_ground = *site_from_body * path.body_from_ground,
                      .contact = path.contact});
  }
  return photos;
}

int PaintDrive(const TextureSource& source, const CellFinder& cells, const TextureOptions& options,
               std::vector<ChartPainter>& painters) {
  KeyframePicker picker(source.path->site_from_body, source.log->rig().cameras.size(), options.keyframe_distance,
                        options.keyframe_angle_deg * std::numbers::pi / 180);
  const auto stream =
      source.log->Read({.imu = false,
                        .wheels = false,
                        .gnss = false,
                        .images = true,
                        .semantics = false,
                        .grayscale = false,
                        .wants_image = [&](int camera, Timestamp time) { return picker.Wants(camera, time); }});
  int num_photos = 0;
  while (true) {
    std::vector<GroundPhoto> photos = NextPhotos(*stream, source);
    if (photos.empty()) return num_photos;
    num_photos += static_cast<int>(photos.size());
    ParallelFor(photos.size(), [&](std::size_t i) { photos[i].gain = FindGain(photos[i], cells, options.max_range); });
    ParallelFor(painters.size(), [&](std::size_t i) {
      for (const GroundPhoto& photo : photos) painters[i].Paint(photo, options.max_range);
    });
  }
}

}  // namespace

void TextureOptions::Validate() const {
  Require(texel_size >= 0.002 && texel_size <= 1, ErrorCode::kUsage, "texel_size must be in 0.002..1 m");
  Require(chart_size >= 10 * texel_size && chart_size <= 8000 * texel_size, ErrorCode::kUsage,
          "chart_size must be 10 to 8000 texels");
  Require(max_range > 0, ErrorCode::kUsage, "max_range must be > 0 m");
  Require(keyframe_distance > 0 && keyframe_angle_deg > 0, ErrorCode::kUsage,
          "keyframe_distance and keyframe_angle_deg must be > 0");
}

GroundTexture PaintTexture(const TriangleMesh& mesh, const SurfaceMap& surface, std::span<const TextureSource> sources,
                           const TextureOptions& options) {
  options.Validate();
  GroundTexture texture{options.texel_size, options.chart_size, {}};
  if (!options.enabled || mesh.empty()) return texture;
  std::vector<ChartPainter> painters;
  for (BlankChart& blank : CutIntoCharts(mesh, options.chart_size, options.texel_size))
    painters.emplace_back(std::move(blank), options.texel_size);
  const CellFinder cells(surface);
  int num_photos = 0;
  for (const TextureSource& source : sources) num_photos += PaintDrive(source, cells, options, painters);
  texture.charts = ParallelMap(painters.size(), [&](std::size_t i) { return painters[i].Finish(cells); });
  LogInfo("stage=paint_texture charts=" + std::to_string(texture.charts.size()) +
          " photos=" + std::to_string(num_photos));
  return texture;
}

}  // namespace parkade

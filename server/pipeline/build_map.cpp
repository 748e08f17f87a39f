#include "server/pipeline/build_map.h"

#include "core/tune_malloc.h"
#include "server/pipeline/drive_stages.h"
#include "server/pipeline/join_site.h"
#include "server/pipeline/observe_site.h"
#include "server/pipeline/preview_map.h"
#include "server/pipeline/slot_looks.h"
#include "server/pipeline/track_drives.h"

namespace parkade {

BuiltMap BuildMap(std::span<const std::unique_ptr<RecordedDrive>> logs, const MapOptions& options,
                  const BuildScope& scope, Progress& progress) {
  const BuildContext context(options, scope);
  BuiltMap built;
  built.left_out = scope.unreadable;
  SiteMap& map = built.site;
  const auto begin = [&progress](const char* stage) {
    ReleaseIdleMemory();
    progress.Begin(stage);
  };

  begin("track");
  std::vector<DriveInWork> drives = TrackDrives(logs, context, progress, built.left_out);

  begin("close loops");
  progress.ForEach(drives, [&](DriveInWork& drive) { CloseLoops(context, drive); });
  PreviewLoops(context, drives);

  begin("refine");
  progress.ForEach(drives, [&](DriveInWork& drive) { Refine(context, drive); });

  begin("join drives");
  JoinSite(context, drives, built);
  WarnOfLosses(drives, built);
  PutOnEarth(context, built);
  PreviewSite(context, map);
  if (scope.is_odometry_only) return built;

  begin("observe ground");
  const SiteGround ground = ObserveSite(context, drives, progress, built);

  begin("fuse surface");
  map.surface = FuseSurface(ground.patches, ground.paths, ground.heights, options.surface);

  begin("mesh");
  map.mesh = MeshSurface(map.surface, options.mesh);
  if (map.mesh.empty())
    built.warnings.push_back("no ground was found: the map holds trajectories only");

  begin("texture");
  std::vector<TextureSource> sources;
  for (size_t i = 0; i < drives.size(); ++i)
    sources.push_back({&*drives[i].calibrated, &ground.paths[i]});
  map.texture = PaintTexture(map.mesh, map.surface, ground.patches, sources, options.texture);

  begin("slots by drive");
  std::vector<SlotLook> looks = LooksBefore(context, drives, ground, map, progress);

  begin("find markings");
  map.markings = FindMarkings({map.mesh, map.surface, map.texture, ground.patches, ground.paths,
                               map.drives.size(), std::move(looks)},
                              options.markings);
  NameAndKeepSlots(context, drives, ground, map);
  return built;
}

}  // namespace parkade

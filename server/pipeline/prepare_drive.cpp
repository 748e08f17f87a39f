#include "server/pipeline/prepare_drive.h"

#include <vector>

#include "server/pipeline/drive_stages.h"
#include "server/pipeline/track_drives.h"

namespace parkade {

void PrepareDrive(const std::unique_ptr<RecordedDrive>& log, const MapOptions& options,
                  const BuildScope& scope, Progress& progress) {
  const BuildContext context(options, scope);
  std::vector<LeftOutDrive> left_out;  // a drive alone is not: it throws
  progress.Begin("track");
  std::vector<DriveInWork> drives = TrackDrives(std::span(&log, 1), context, progress, left_out);
  DriveInWork& drive = drives.front();

  progress.Begin("close loops");
  CloseLoops(context, drive);

  progress.Begin("refine");
  Refine(context, drive);
  KeepKeyframes(context, drive);

  progress.Begin("observe ground");
  const Keyed<std::shared_ptr<const GroundFile>> ground = ObserveGround(context, drive);
  if (options.surface.method == "surface") MeasureHeights(context, drive, ground, 0);
  progress.Finish();
}

}  // namespace parkade

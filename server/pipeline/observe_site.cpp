#include "server/pipeline/observe_site.h"

#include "core/tune_malloc.h"

namespace parkade {

SiteGround ObserveSite(const BuildContext& context, const std::vector<DriveInWork>& drives,
                       Progress& progress, BuiltMap& built) {
  SiteGround ground;
  for (size_t i = 0; i < drives.size(); ++i) {
    const int number = static_cast<int>(i);
    const Keyed<std::shared_ptr<const GroundFile>> file = ObserveGround(context, drives[i]);
    const GroundObservation& seen = file.value->observation();
    built.drives[i].num_ground_images = seen.num_images;
    built.warnings.insert(built.warnings.end(), seen.warnings.begin(), seen.warnings.end());
    ReleaseIdleMemory();
    if (context.options.surface.method == "surface")
      ground.heights.push_back(MeasureHeights(context, drives[i], file, number).value);

    const SiteDrive& site_drive = built.site.drives[i];
    const Trajectory& site_from_body = site_drive.site_from_body_trajectory;
    ground.paths.push_back(
        MakeDrivenPath(number, site_drive.rig, site_from_body, seen.body_from_ground));
    ground.patches.Add(file.value, number, site_from_body);
    ground.files.push_back(file);
    progress.Update(static_cast<double>(i + 1) / static_cast<double>(drives.size()));
  }
  return ground;
}

}  // namespace parkade

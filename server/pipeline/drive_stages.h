#pragma once

#include <memory>

#include "mapping/heights/drive_heights.h"
#include "server/map_folder/ground_file.h"
#include "server/pipeline/build_context.h"
#include "server/pipeline/drive_in_work.h"

namespace parkade {

// The stages that look at one drive. Each takes what earlier ones left in `drive`, and makes its
// product or takes it from the map that the build starts from: a drive that joins a site of many
// costs its own work.

/// Loops of the odometry, with what reviewers decided on them.
void CloseLoops(const BuildContext& context, DriveInWork& drive);

/// The drive's refinement after its loops; the measurements that it was made from are let go.
void Refine(const BuildContext& context, DriveInWork& drive);

/// What is seen at the rig's keyframes along the refined drive.
void DescribeKeyframes(const BuildContext& context, DriveInWork& drive);
/// The same, but it is only kept for maps to come: few keyframes are in memory at a time.
void KeepKeyframes(const BuildContext& context, const DriveInWork& drive);

/// What the drive sees of the ground, in the map's folder, which there must be.
Keyed<std::shared_ptr<const GroundFile>> ObserveGround(const BuildContext& context,
                                                       const DriveInWork& drive);

/// What it knows of the ground's height. \param number  of the drive in the site
Keyed<DriveHeights> MeasureHeights(const BuildContext& context, const DriveInWork& drive,
                                   const Keyed<std::shared_ptr<const GroundFile>>& ground,
                                   int number);

}  // namespace parkade

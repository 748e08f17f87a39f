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

inline constexpr const char* kRefinementFile = "/refinement.bin";  ///< in a drive's folder

/// Closes the loops of the odometry, under the decisions of reviewers.
void CloseLoops(const BuildContext& context, DriveInWork& drive);

/// Refines the drive after its loops are closed, and lets go of the measurements behind it.
void Refine(const BuildContext& context, DriveInWork& drive);

/// Describes the keyframes along the refined drive, or leaves that to `describe` where an earlier
/// map has them and their words; the drive must stay where it is until then.
void DescribeKeyframes(const BuildContext& context, DriveInWork& drive);
/// Describes keyframes only to keep them for later maps: few are in memory at a time.
void KeepKeyframes(const BuildContext& context, DriveInWork& drive);

/// Observes the ground along the drive, into the map's folder, which must exist.
Keyed<std::shared_ptr<const GroundFile>> ObserveGround(const BuildContext& context,
                                                       const DriveInWork& drive);

/// Measures the ground's height along the drive. \param number  of the drive in the site
Keyed<DriveHeights> MeasureHeights(const BuildContext& context, const DriveInWork& drive,
                                   const Keyed<std::shared_ptr<const GroundFile>>& ground,
                                   int number);

}  // namespace parkade

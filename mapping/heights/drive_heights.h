#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/trajectory.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/ground_squares.h"
#include "mapping/heights/height_field.h"
#include "mapping/heights/measure_heights_options.h"
#include "mapping/heights/tied_heights.h"

namespace parkade {

/// How heights of the ground are found.
struct HeightOptions {
  HeightFieldOptions field;
  MeasureHeightsOptions sweep;
};

/// Heights that were measured along one path of their drive.
struct HeightsAlong {
  std::vector<TimedPose> path;  ///< SparsePoses of it
  std::uint64_t num_swept = 0;
};

/// What one drive by itself knows of the height of the ground. It depends on this drive alone, so
/// that it is found once, however many drives join it later.
struct DriveHeights {
  int drive = 0;
  SuspensionModel lean;
  double plane_errors = 1;         ///< of SuspensionFit
  std::vector<DriveHeight> swept;  ///< where its views agree: MeasureHeights
  std::vector<DriveHeight>
      planes;  ///< where its keyframes' planes have the ground: one per square and deck
  std::vector<HeightsAlong> along;  ///< in the order of `swept`: see MeasureMovedHeights
};

/// Heights of one drive: a field is fitted to the wheel contacts and the planes of keyframes, and
/// the sweep measures the ground beside the path, round by round outwards. The first round also
/// tells how the car leans. \param patches of this drive alone, in any frame whose z is up \param
/// path      its path in that frame, or null where it has none \param measured  heights in that
/// frame that something else knows
DriveHeights MeasureDriveHeights(const PatchSource& patches, const DrivenPath* path,
                                 const HeightOptions& options,
                                 std::span<const HeightObservation> measured = {});

/// Heights of a drive whose path has moved: those in `squares` are measured again, round by round;
/// others stay tied as they are. How the car leans is known from before. \param before  with one
/// path at least in `along`
DriveHeights MeasureMovedHeights(const PatchSource& patches, const DrivenPath& path,
                                 const HeightOptions& options, const DriveHeights& before,
                                 const GroundSquares& squares);

/// The surface that fits what all drives know, wherever their paths lie by now. Planes share their
/// errors, so that many of them in one square say hardly more than the best. Does not depend on the
/// order of the drives but for rounding.
HeightField FitHeights(std::span<const DriveHeights> drives, std::span<const DrivenPath> paths,
                       const HeightOptions& options,
                       std::span<const HeightObservation> measured = {});

/// The road alone, as it would go on beside the paths: wheel contacts and planes of keyframes. What
/// lies above it is a kerb, an island, a pavement, or a ramp that nobody drove on.
HeightField FitRoad(std::span<const DriveHeights> drives, std::span<const DrivenPath> paths,
                    const HeightOptions& options);

}  // namespace parkade

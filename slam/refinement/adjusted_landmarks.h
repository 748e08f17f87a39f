#pragma once

#include <cstdint>
#include <vector>

#include "slam/refinement/adjusted_drive.h"
#include "slam/refinement/refinement_options.h"

namespace parkade {

/// Where a track was seen: an image, and the observation's place in it.
struct TrackInImage {
  std::uint32_t image = 0, observation = 0;
};
using ChosenTrack = std::vector<TrackInImage>;

/// Tracks worth a landmark, the longest first, as long as one of their images has not got enough.
std::vector<ChosenTrack> ChooseTracks(const DriveMeasurements& measurements,
                                      const RefinementOptions& options);

/// Adds a landmark for each track whose bearings meet.
void AddLandmarks(const DriveMeasurements& measurements, const std::vector<ChosenTrack>& tracks,
                  AdjustedDrive& drive);

/// Puts all landmarks where their bearings meet, from the nodes' current poses.
void TriangulateLandmarks(AdjustedDrive& drive);

/// Every so many-th landmark pulls nothing and judges the others; 0: all pull.
void HoldOutLandmarks(size_t every, AdjustedDrive& drive);

/// Moves each landmark to where its bearings meet best, from the nodes' current poses.
void FitLandmarks(AdjustedDrive& drive);

/// Leaves out bearings that are too far off, and landmarks that too few are left of.
void RejectOutliers(AdjustedDrive& drive);

/// Half the sum of the losses of a landmark's bearings.
double RobustErrorOf(const AdjustedDrive& drive, const AdjustedLandmark& landmark);

}  // namespace parkade

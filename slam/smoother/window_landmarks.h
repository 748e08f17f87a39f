#pragma once

#include <optional>

#include "slam/smoother/smoother_window.h"

namespace parkade {

/// Triangulates tracks that the newest images see, the longest first, until the cameras together
/// have `max_landmarks`.
void StartLandmarks(int max_landmarks, SmootherWindow& window);

/// Leaves out bearings that are too far off their landmarks, and landmarks of which too little is
/// left.
void RejectOutliers(SmootherWindow& window);

/// The point of a landmark that leaves with the oldest node; nothing where it has no distance.
std::optional<FinishedLandmark> FinishLandmark(const SmootherWindow& window, const Track& track);

}  // namespace parkade

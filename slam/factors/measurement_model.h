#pragma once

namespace parkade {

// How a drive's measurements are weighed and believed: the same in the odometry's window and in the
// adjustment of the whole drive.

/// [sigma] of the Cauchy loss of bearings, wheels (slip), loops and fixes.
inline constexpr double kRobustWidth = 2;
/// [sigma] A bearing further off is left out.
inline constexpr double kMaxBearingError = 5;
/// [sigma] Rays that are further off each other do not become a landmark.
inline constexpr double kMaxStartError = 10;
/// [m] Landmarks nearer than this are the car itself or nonsense.
inline constexpr double kMinLandmarkDistance = 0.3;
/// [a b] A landmark that moved further than this from its ray gets a new one.
inline constexpr double kMaxLandmarkTangent = 0.1;
/// How far the tires' radius may be off before the drive tells, relative.
inline constexpr double kWheelScaleSigma = 0.01;
/// [m] Sensors this near to each other are one piece, a stereo head: it may sit askew, its parts do
/// not.
inline constexpr double kHeadSize = 1.0;

/// Variance of what a track's errors add up to / what its residuals show of it: a patch slides
/// along the flow as it grows, and tracks that live side by side slide alike, so that residuals are
/// the smaller part. Measured on drives with known truth, see docs/decisions/0014.
inline constexpr double kCommonErrors = 6;

}  // namespace parkade

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geoid.h"
#include "core/site_map.h"

namespace parkade {

/// site_from_imu at every state of the final trajectory and of the odometry, and in between so that
/// no gap is longer than `max_gap` [s]. Covers the spans of both: between final states the odometry
/// gives the motion and the correction (final against odometry) is interpolated, beyond them it is
/// held.
std::vector<TimedPose> SampleFinalTrajectory(const SiteDrive& drive, double max_gap = 0.05);

/// site_from_imu of the odometry alone, one pose per state. Turned about z and moved so that it
/// starts where the final trajectory does; nothing else of the final trajectory is in it.
std::vector<TimedPose> SampleOdometry(const SiteDrive& drive);

/// RFC 7946: one LineString (longitude, latitude, ellipsoidal height where known) of the body's
/// origin with `times_s` in the properties.
std::string EncodeTrajectoryGeoJson(const SiteDrive& drive, const SiteDatum& datum);

/// OGC KML 2.2, one LineString. Its heights count from mean sea level where there is a geoid;
/// without one they are ellipsoidal, which its description says. Where nobody knows how high the
/// site lies, the line is on the ground.
std::string EncodeTrajectoryKml(const SiteDrive& drive, const SiteDatum& datum,
                                const std::optional<Geoid>& geoid = std::nullopt);

}  // namespace parkade

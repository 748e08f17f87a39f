#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/ground_markings.h"
#include "export/free_space.h"

namespace parkade {

/// GeoJSON: one Polygon per slot, its entrance first. Properties: `id`, `type`, `width_m`,
/// `length_m`, `angle_deg` (between the lines beside it and the row), `level` (of `sheets`),
/// `height_m`, `confidence`, `marked_sides`, `states` (by drive: free, occupied or unseen), `state`
/// (of the last drive that saw it) and `corners_m` (in site). With a datum WGS84 (RFC 7946);
/// without, site meters, said by "frame": "site". \param drives  names, as ParkingSlot::states
std::string EncodeSlotsGeoJson(const std::vector<ParkingSlot>& slots,
                               const std::vector<std::string>& drives,
                               const std::vector<FreeSheet>& sheets,
                               const std::optional<SiteDatum>& datum);

/// GeoJSON of all other markings: LineStrings of `type` "line" with `color`, `width_m` and
/// `bounds_slot`; Polygons of `type` "area" with `color`; Points of `type` "speed_bump" with
/// `height_m`, `length_m`, `yaw_deg` (of the way over it, counter-clockwise from the site's x) and
/// `passes`; and LineStrings of `type` "kerb", the drivable ground on the left, with `height_m` (of
/// the top above that ground), `height_sigma_m`, `length_m`, `hidden_m` (of it that nobody saw) and
/// `points_m` (in site).
std::string EncodeMarkingsGeoJson(const GroundMarkings& markings,
                                  const std::vector<FreeSheet>& sheets,
                                  const std::optional<SiteDatum>& datum);

/// What most recently was known of a slot.
SlotState LatestState(const ParkingSlot& slot);

}  // namespace parkade

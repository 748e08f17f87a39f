#pragma once

#include <string>
#include <vector>

#include "core/ground_markings.h"
#include "server/pipeline/carry_slots.h"

namespace parkade {

/// A drive by which slots are named.
struct NamingDrive {
  std::string name;
  MovedDrive odometry_from_site;  ///< `after`: its odometry, which later drives never change
};

/// Names the slots that have no id: after the drive that passed nearest and where its odometry has
/// them, to half a meter. So a slot has the same id in each map that is made from this drive first,
/// however the site moves or turns, and a slot that other drives find has one of its own. No id is
/// given twice.
void NameSlots(const std::vector<NamingDrive>& drives, std::vector<ParkingSlot>& slots);

}  // namespace parkade

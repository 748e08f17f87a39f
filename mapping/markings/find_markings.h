#pragma once

#include "core/ground_markings.h"
#include "core/option_about.h"
#include "mapping/kerbs/find_kerbs.h"
#include "mapping/markings/find_slots.h"
#include "mapping/markings/find_speed_bumps.h"

namespace parkade {

struct MarkingOptions {
  bool enabled = true;  ///< needs the texture
  PaintLineOptions lines;
  SlotRowOptions slots;
  KerbOptions kerbs;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("enabled", enabled,
          OptionAbout{"Markings, slots, kerbs and speed bumps are looked for."});
    visit("slots", slots);
    visit("kerbs", kerbs);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Parking slots with what each drive saw in them, other paint, speed bumps, and kerbs.
///
/// Lines and areas of paint are found in the texture (FindPaint); rows of lines are slots, beside
/// those that other looks found (FindSlots); the heights that the wheels drove over say where bumps
/// are (FindSpeedBumps); what is seen beyond the outline says where kerbs are (FindKerbs). Without
/// a texture there are bumps and kerbs only. In parallel over tiles, the same every time.
GroundMarkings FindMarkings(const MarkedGround& ground, const MarkingOptions& options = {});

}  // namespace parkade

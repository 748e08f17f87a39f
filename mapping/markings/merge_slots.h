#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/markings/slot_sides.h"
#include "mapping/markings/slot_states.h"

namespace parkade {

/// Slots that one look at the ground found, in site: a drive's own, an earlier map's, or those that
/// all drives together show.
struct SlotLook {
  std::vector<ParkingSlot> slots;
  int drive = -1;  ///< the latest drive that has a say in it: what later ones see may contradict it
  bool establishes = true;  ///< false: it only says what slots are called
  std::vector<bool> tells_of =
      {};  ///< by drive: whether its slots' states, where they have any, say what that drive saw
};

/// A slot that one or more looks found.
struct SlotCandidate {
  ParkingSlot slot;        ///< as the surest look has it, by the name of the first that has one
  int last_drive = -1;     ///< the latest that has a say in it
  SlotSides sides = {};    ///< what is seen of its lines now
  KnownStates known = {};  ///< what drives saw in it, as the first look that found it says
};

/// The slots of all looks, each once: those that overlap by two fifths or more are the same one.
/// That is less than two slots of rows laid out anew share, and more than half of what the same
/// slot shares with itself, found shorter. Looks whose names count most come first; the look that
/// shows what is there now comes last. By look, then in its order. O(slots^2).
std::vector<SlotCandidate> MatchLooks(std::span<const SlotLook> looks);

/// The candidates that are slots, in their order; ParkingSlot::states say what drives saw.
///
/// What one look found stays where later ones do not find it: parked cars, shadows and wear hide
/// paint. It is gone where both lines beside it are seen to be bare ground and a drive that has no
/// say in it saw no car there. A slot with one bare line stays, less sure. Of slots that overlap
/// the surer one stays, and of about equally sure ones the earlier, but slots with a bare line, and
/// those of a row of which more slots are gone than stand, give way.
std::vector<ParkingSlot> ChooseSlots(const std::vector<SlotCandidate>& candidates);

}  // namespace parkade

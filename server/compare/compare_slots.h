#pragma once

#include <string>
#include <vector>

#include "core/rigid3.h"
#include "server/map_folder/slots_file.h"

namespace parkade {

/// A slot that both versions of a map have, known to be free or occupied in both.
struct SlotChange {
  std::string id;  ///< in the later map
  SlotState from = SlotState::kUnseen, to = SlotState::kUnseen;
};

/// How the parking slots of two versions differ.
struct SlotChanges {
  std::vector<std::string> added;    ///< ids in the later map
  std::vector<std::string> removed;  ///< ids in the earlier map
  std::vector<SlotChange> changed;   ///< taken or left since
  std::size_t num_kept = 0;          ///< slots in both, changed or not
};

/// Slots that overlap by half or more are the same one, and those of one id that overlap by a
/// fifth. A slot's state in a version is that of the
/// last drive that saw it. `to_from_from` moves the earlier map's site into the later one's.
SlotChanges CompareSlots(const std::vector<StoredSlot>& from, const std::vector<StoredSlot>& to,
                         const Rigid3& to_from_from);

}  // namespace parkade

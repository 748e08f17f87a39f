#pragma once

#include <map>
#include <optional>

#include "core/files/appended_file.h"
#include "core/timestamp.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Described keyframes of a drive in a scratch file, of which a long drive has too many to hold.
class KeyframeStore {
 public:
  void Add(const RigKeyframe& keyframe);
  bool Has(Timestamp time) const { return places_.count(time) > 0; }
  /// The keyframe of that time, exactly as it was added. Several threads may ask at once, while
  /// none adds.
  std::optional<RigKeyframe> Find(Timestamp time) const;

 private:
  struct Place {
    std::uint64_t offset = 0;
    size_t size = 0;
  };
  AppendedFile file_;
  std::map<Timestamp, Place> places_;  ///< in file_
};

}  // namespace parkade

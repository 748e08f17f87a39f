#pragma once

#include <optional>
#include <vector>

#include "slam/sessions/drive_to_join.h"

namespace parkade {

/// Drives of a site that lie to each other as an earlier map has them, and stay so while others
/// join them: what one more drive costs does not grow with their number.
class SettledDrives {
 public:
  SettledDrives() = default;  ///< none
  /// \param site_from_body  by drive, in the frame of the earlier map; nothing where it lacks one
  SettledDrives(const std::vector<DriveToJoin>& drives,
                const std::vector<std::optional<Trajectory>>& site_from_body);

  bool empty() const { return first_ == poses_.size(); }
  std::size_t first() const { return first_; }  ///< of them
  bool Holds(std::size_t drive) const { return drive < poses_.size() && !poses_[drive].empty(); }
  bool HoldBoth(const DrivePair& pair) const { return Holds(pair.drive_a) && Holds(pair.drive_b); }
  /// Where the keyframes of one of them lie.
  const std::vector<Rigid3>& PosesOf(std::size_t drive) const { return poses_[drive]; }

  /// Sets the weights of the links between them, each by its own error; says whether those that
  /// are believed hold all of them together.
  bool Weigh(std::vector<DrivePair>& pairs) const;

 private:
  std::vector<std::vector<Rigid3>> poses_;  // by drive
  std::size_t first_ = 0;
};

/// Whether a site that had `before` drives is to be joined anew now that it has `now`: while they
/// are few, and whenever there are half as many again or twice as many, so that early drives gain
/// from what later ones saw.
bool IsToBeSettled(std::size_t before, std::size_t now);

}  // namespace parkade

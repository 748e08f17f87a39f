#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "slam/sessions/drive_to_join.h"

namespace parkade {

/// What a person decided about single links between drives, by their names in report.json,
/// "DRIVE:KEYFRAME~DRIVE:KEYFRAME".
struct LinkReview {
  std::vector<std::string> rejected = {};  ///< do not join the drives
  std::vector<std::string> forced = {};    ///< are not doubted; measured where none was found
};

/// The keyframes of two drives that a link ties, by indices; drive_a < drive_b.
struct LinkEnds {
  size_t drive_a = 0, keyframe_a = 0, drive_b = 0, keyframe_b = 0;
  bool operator==(const LinkEnds&) const = default;
};

/// The ends of the link of that name between two of the drives called `names`, whichever comes
/// first; nothing where it names other drives, or is no name of a link.
std::optional<LinkEnds> FindEnds(const std::string& id, const std::vector<std::string>& names);

/// The name of a link.
std::string NameOf(const LinkEnds& ends, const std::vector<std::string>& names);

/// A review's decisions on the links between the drives called `names`; what is decided about
/// others is left aside.
class ReviewedLinks {
 public:
  ReviewedLinks() = default;
  ReviewedLinks(const LinkReview& review, const std::vector<std::string>& names);

  bool Rejects(const LinkEnds& link) const;
  const std::vector<LinkEnds>& forced() const { return forced_; }
  /// Sets the pair's rejected links aside, and marks those that are forced. For a pair as it was
  /// found.
  void Judge(DrivePair& pair) const;

 private:
  std::vector<LinkEnds> rejected_, forced_;
};

bool HasLink(const DrivePair& pair, const LinkEnds& ends);

/// Throws Error{kUsage} for a decision that could not be followed: one about other drives than
/// those called `names`, a rejected link that was not found, a forced one that cannot be measured.
void RequireLinks(const LinkReview& review, const std::vector<std::string>& names,
                  const std::vector<DrivePair>& pairs);

}  // namespace parkade

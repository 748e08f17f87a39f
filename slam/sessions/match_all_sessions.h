#pragma once

#include <vector>

#include "slam/sessions/drive_to_join.h"

namespace parkade {

struct MatchedSessions {
  std::vector<DrivePair> pairs;
  PairFindings findings;  ///< about all pairs that were asked for, known or new
};

/// Links between the drives of a site by MatchSessions, gated by GNSS where both drives have it. Up
/// to options.all_pairs_up_to drives every pair is linked. If there are more, each drive is linked
/// with the options.partners before it that look most like it, so that the work for one more drive
/// does not grow with the site; where that leaves groups of drives apart, their most alike pairs
/// are tried too, as many times. Pairs in order of drive_b, then drive_a; does not depend on the
/// order in which drives came to the site, only on that in `drives`.
///
/// \param known findings that are taken instead of found anew; they must be what would be found,
/// bit by bit
MatchedSessions MatchAllSessions(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
                                 const SessionLoopOptions& options, const PairFindings& known = {});

/// Drives that hang together by accepted links have the same number, the lowest of their indices.
std::vector<size_t> FindGroups(size_t num_drives, const std::vector<DrivePair>& pairs);

}  // namespace parkade

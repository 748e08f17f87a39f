#pragma once

#include <string>
#include <vector>

#include "server/pipeline/build_context.h"
#include "server/pipeline/drive_in_work.h"
#include "slam/sessions/drive_to_join.h"

namespace parkade {

/// What was found out about pairs of drives, kept in a file of the later drive of each pair, so
/// that a further drive leaves the files of all others as they are.
class KeptPairs {
 public:
  /// \param drives  borrowed; with keyframes and, where there is one, their alignment to GNSS
  KeptPairs(const BuildContext& context, const std::vector<DriveInWork>& drives);

  /// All that the map to start from, or an unfinished try, found of pairs that look the same today.
  PairFindings Find() const;

  /// Keeps the findings that a build asked for.
  void Keep(const PairFindings& findings) const;

 private:
  std::string FileOf(std::size_t later) const;

  const BuildContext& context_;
  const std::vector<DriveInWork>& drives_;
  std::vector<std::string> keys_;  ///< by drive: of all that findings about it depend on
};

}  // namespace parkade

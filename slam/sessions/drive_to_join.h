#pragma once

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "slam/georeference/align_to_gnss.h"
#include "slam/loops/loop_closure.h"
#include "slam/pose_graph/pose_graph.h"
#include "slam/refinement/covariance_modes.h"
#include "slam/sessions/session_loops.h"

namespace parkade {

/// One drive as it stands alone: loops closed and refined.
struct DriveToJoin {
  Trajectory odom_from_body;  ///< final
  /// All of them, see KeyframesAlong; a drive alone needs none. With `describe` they only need to
  /// lie where they are.
  std::vector<RigKeyframe> keyframes;
  LoopClosure loops;                  ///< between these keyframes
  std::optional<GnssAlignment> gnss;  ///< all drives' in one datum
  CovarianceModes modes = {};         ///< how it may be off; empty: the random walk of AddKeyframes
  std::optional<PlaceWords> words = {};  ///< of the keyframes; nothing: found where they are needed
  /// The keyframes with what they show, which most drives of a site are not asked for; empty:
  /// `keyframes` show it.
  std::function<std::vector<RigKeyframe>()> describe = {};
};

/// What the keyframes of drives show, found when it is first asked for.
class DescribedDrives {
 public:
  /// The drives are borrowed.
  explicit DescribedDrives(const std::vector<DriveToJoin>& drives) : drives_(drives) {}

  /// Throws Error{kInternal} where a drive describes other keyframes than it has.
  const std::vector<RigKeyframe>& KeyframesOf(size_t drive);
  /// The words of a drive, which cost less to ask for.
  PlaceWords WordsOf(size_t drive);

 private:
  const std::vector<DriveToJoin>& drives_;
  std::map<size_t, std::vector<RigKeyframe>> described_;
};

/// A link that was found, and that a reviewer rejected.
struct RejectedLink {
  SessionLoop link;
  double chi_squared = 0;  ///< [sigma^2] of it once all drives are joined without it
};

/// Two drives and what links them.
struct DrivePair {
  size_t drive_a = 0, drive_b = 0;
  SessionLoops found;
  std::vector<double> weights;      ///< of found.links: 1 where the joint graph believed it
  std::vector<double> chi_squared;  ///< [sigma^2] of found.links once all drives are joined

  std::vector<bool> is_forced = {};         ///< of found.links, by a reviewer; empty: none is
  std::vector<RejectedLink> rejected = {};  ///< not among found.links any more

  int num_accepted() const;
  bool IsForced(size_t link) const { return link < is_forced.size() && is_forced[link]; }
};

/// Two drives by their indices, the lower one first.
using PairOfDrives = std::pair<size_t, size_t>;

/// What was found about pairs of drives, so that a later build with the same two need not find it
/// again.
struct PairFindings {
  std::map<PairOfDrives, double> similarities;  ///< SimilarityOf
  std::map<PairOfDrives, SessionLoops> loops;   ///< MatchSessions
};

/// [sigma^2] of a link between keyframes that lie at these poses in one frame.
double SquaredErrorOf(const SessionLoop& link, const Rigid3& frame_from_a,
                      const Rigid3& frame_from_b);

/// The loops of a drive that were believed, between its keyframes as they are: its final trajectory
/// has them closed, so that they only hold it together as firmly as they were measured. Edges
/// between vertices from `first_vertex` on.
void AddClosedLoops(const DriveToJoin& drive, size_t first_vertex, PoseGraph& graph);

}  // namespace parkade

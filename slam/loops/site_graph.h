#pragma once

#include <span>
#include <vector>

#include "slam/loops/close_loops.h"
#include "slam/pose_graph/pose_graph.h"

namespace parkade {

/// A drive of a finished site, and what has become of its loops since. All members come from one
/// odometry.
struct RevisitedDrive {
  Trajectory odometry;        ///< odom_from_body
  LoopClosure before, after;  ///< as the site has its loops, and as they are now
  Trajectory site_from_body;  ///< as the site has it

  bool HasChanged() const;  ///< whether other loops are believed now
  bool HasLost() const;     ///< whether a loop that was believed no longer is
};

/// A link between keyframes of two drives by which the site was joined.
struct KeptLink {
  size_t drive_a = 0, drive_b = 0, keyframe_a = 0, keyframe_b = 0;  ///< indices
  Rigid3 a_from_b;
  Matrix6d information = Matrix6d::Zero();
};

/// The keyframes of all drives of a site as one graph.
struct SiteGraph {
  PoseGraph graph;  ///< solved; vertex 0 is the world, the keyframes follow, drive after drive
  std::vector<Rigid3> before;        ///< per vertex: where the site has it
  std::vector<size_t> first_vertex;  ///< per drive: of its first keyframe
  int num_links = 0;                 ///< how many are believed
};

/// Where the drives of a site lie once loops have changed, before anything is refined anew:
/// odometry, gravity, the loops that CloseLoops believed (those with scale) and the site's links,
/// of which graduated non-convexity leaves out those that no longer fit; what is left out is no
/// edge of the result. A drive that lost none of its loops keeps the shape that its refinement gave
/// it, as far as new loops let it; one that lost a loop was bent by it, and has the shape that
/// odometry saw. The first keyframe of the first drive is held; a drive that nothing links to it
/// stays where it begins. Throws Error{kInvalidInput} without any keyframe.
SiteGraph RegraphSite(std::span<const RevisitedDrive> drives, std::span<const KeptLink> links,
                      const LoopOptions& options);

}  // namespace parkade

#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slam/georeference/align_to_gnss.h"
#include "slam/loops/loop_closure.h"
#include "slam/pose_graph/pose_graph.h"
#include "slam/refinement/bending_modes.h"
#include "slam/sessions/drive_links.h"

namespace parkade {

/// One drive as it stands alone: loops closed and refined.
struct DriveToJoin {
  Trajectory odom_from_body;          ///< final
  std::vector<Place> places;          ///< all of them, see PlacesAlong; a drive alone needs none
  LoopClosure loops;                  ///< between these places
  std::optional<GnssAlignment> gnss;  ///< all drives' in one datum
  BendingModes modes = {};            ///< how it may be off; empty: as AddPlaces has it
};

/// Two drives and what links them.
struct DrivePair {
  size_t drive_a = 0, drive_b = 0;
  DriveLinks found;
  std::vector<double> weights;      ///< of found.links: 1 where the joint graph believed it
  std::vector<double> chi_squared;  ///< [sigma^2] of found.links once all drives are joined

  int num_accepted() const;
};

/// Gives what `compute` gives, or gave for the same two drives in an earlier build; `what` names it. Drives by index.
using PairMemory = std::function<std::string(const std::string& what, size_t drive_a, size_t drive_b,
                                             const std::function<std::string()>& compute)>;

/// The loops of a drive that were believed, between its places as they are: its final trajectory has them closed, so
/// that they only hold it together as firmly as they were measured. Edges between vertices from `first_vertex` on.
void AddClosedLoops(const DriveToJoin& drive, size_t first_vertex, PoseGraph& graph);

}  // namespace parkade

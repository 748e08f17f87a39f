#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/sessions/adjust_jointly.h"
#include "slam/sessions/drive_to_join.h"
#include "slam/sessions/reviewed_links.h"

namespace parkade {

/// The keyframes that CloseLoops found along `odometry`, where `odom_from_body` puts them.
/// KeyframeMover takes what is seen there to them.
std::vector<RigKeyframe> KeyframesAlong(const Trajectory& odometry,
                                        const Trajectory& odom_from_body,
                                        const KeyframeOptions& options);

/// One drive in the site's frame, or why it is left out.
struct JoinedDrive {
  Trajectory site_from_body;           ///< empty where left out
  std::string left_out;                ///< reason; empty where joined
  bool is_held_by_gnss_alone = false;  ///< no links hold it to most of the others
};

struct DriveJoin {
  std::vector<JoinedDrive> drives;  ///< as they were given
  std::vector<DrivePair> pairs;
  PairFindings findings;       ///< from which `pairs` were made
  JointAdjustment adjustment;  ///< of the group with the most links
  double seconds = 0;          ///< of computing
};

/// Joins drives of one site: links between them by MatchAllSessions; one pose graph of the
/// keyframes of all drives that links hold together, with the drives' own loops and gravity, in
/// which graduated non-convexity doubts the links but for those that a reviewer forces; all these
/// drives adjusted at once, each as its own refinement allows (AdjustJointly); then each such group
/// is placed on Earth by the GNSS of its drives, rigidly. The largest set of drives that hang
/// together by links or by GNSS is kept (of equal ones the one with the longest way); any other
/// drive is left out with a reason. `site` is the datum's tangent plane where a kept drive has
/// GNSS, else the odometry frame of the first kept drive. A single drive is only placed.
///
/// \param settled_before  by drive, or empty: where an earlier map has it (site_from_body), whose
///                        frame the site keeps where none has GNSS. Such drives stay as they lie
///                        to each other, and only the others are adjusted, to those that they have
///                        links with; but all anew where their links do not hold them together
DriveJoin JoinDrives(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
                     const SessionLoopOptions& links, const PairFindings& known = {},
                     const ReviewedLinks& reviewed = {},
                     const std::vector<std::optional<Trajectory>>& settled_before = {});

}  // namespace parkade

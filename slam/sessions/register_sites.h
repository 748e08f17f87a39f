#pragma once

#include <optional>
#include <vector>

#include "slam/sessions/session_loops.h"

namespace parkade {

/// How two sites are thought to lie to each other before any images are compared.
struct SitePrior {
  Rigid3 to_from_from;
  double sigma = 0;  ///< [m] horizontally, where the drives are
};

/// How two sites lie to each other by places that drives of both passed.
struct SiteRegistration {
  Rigid3 to_from_from;  ///< a rotation about z and a translation
  double horizontal_sigma =
      0;  ///< [m] per axis, by which single links disagree: either map's bends, and their errors
  double height_sigma = 0;  ///< [m] by which heights of single links disagree
  size_t num_links = 0;     ///< that agree with it
};

/// Links drives of one site with drives of another (MatchSessions; of many pairs the most alike),
/// then fits one motion to all links: least squares over the keyframes and spots 3 m around them,
/// reweighted by Cauchy's function until wrong links do not count. Nothing where no pair of drives
/// is linked, or less than half of the links agree.
///
/// \param from, to  keyframes per drive, described; odom_from_keyframe is where they lie in their
/// site, level
std::optional<SiteRegistration> RegisterSites(const std::vector<std::vector<RigKeyframe>>& from,
                                              const std::vector<std::vector<RigKeyframe>>& to,
                                              const SessionLoopOptions& options,
                                              const RelativePoseOptions& relative_pose,
                                              const std::optional<SitePrior>& prior = std::nullopt);

}  // namespace parkade

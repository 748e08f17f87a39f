#pragma once

#include "slam/pose_graph/pose_graph.h"

namespace parkade {

/// Which edges that are not trusted agree with other such edges whose ends lie
/// near both of theirs along the odometry, and these with each other: around the loop of the two
/// edges and the two stretches of odometry between them, the error passes a chi^2 test. Wrong loops
/// between random places hardly ever find such a partner. After J. Mangelson et al., "Pairwise
/// Consistent Measurement Set Maximization", ICRA 2018, eq. 4, within a window instead of over all
/// pairs. One flag per edge; trusted edges have false.
///
/// \param max_noise_scale  the test is made with the noise that most partners show, relative to
/// what the edges'
///                         information says, but at most with this
/// \param min_partners     edges that each must agree with, out of those found: among many wrong
/// loops some find one
///                         partner by chance, hardly ever three
std::vector<bool> FindSupportedLoops(const PoseGraph& graph, double max_noise_scale = 1,
                                     int min_partners = 1);

}  // namespace parkade

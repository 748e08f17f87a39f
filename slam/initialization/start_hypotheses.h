#pragma once

#include <vector>

#include "slam/initialization/start_problem.h"

namespace parkade {

/// Motions from which to adjust: the speeds, of 0.3 to 50 m/s, at which the rays of all tracks meet
/// better than at neighboring ones; at least one, the best first. From elsewhere an adjustment
/// ends in another valley: from 10 m/s it does not find 23.
///
/// At each speed down is where the accelerometer has it for a car that keeps its speed along its
/// own axes, so that a bend does not tilt it; the direction is that of the tracks' epipolar planes.
std::vector<StartMotion> FindStartHypotheses(const StartProblem& problem);

}  // namespace parkade

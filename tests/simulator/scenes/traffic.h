#pragma once

#include "tests/simulator/motion/motion.h"
#include "tests/simulator/scenes/scene.h"

namespace parkade::simulator {

/// Lets `count` cars and as many pedestrians move through the scene while the own car
/// drives: a car ahead and one behind it that keep their distance, others that come
/// toward it on the other lane or cross its way at a distance, people on their walks and
/// across the road. Whoever would come nearer to the own car than a meter is left out, and
/// other candidates are tried; so there may be fewer. Appends to `scene.materials`.
void AddTraffic(Scene& scene, const Motion& own, int count, std::uint64_t seed);

/// [m] between the own car's outline and that of anything that moves, at a time.
double TrafficClearance(const Scene& scene, const Motion& own, double time);

}  // namespace parkade::simulator

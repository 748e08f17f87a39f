#pragma once

#include <vector>

#include "tests/simulator/common/mesh.h"

namespace parkade::simulator {

/// A car with body, windows, wheels, lights, plates and mirrors. Its frame:
/// middle of its footprint on the ground, x forward, y left, z up. `style` 0 is a
/// hatchback of 3.95 m, 1 a saloon of 4.60 m, 2 a van of 4.75 m; the seed chooses
/// colors. New materials are appended to `materials`.
Mesh MakeCar(int style, std::uint64_t seed, std::vector<Material>& materials);

/// From the middle of the footprint forward to the rear axle [m], negative.
double RearAxleX(int style);
double Wheelbase(int style);  ///< [m]

}  // namespace parkade::simulator

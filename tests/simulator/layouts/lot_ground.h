#pragma once

#include "tests/simulator/common/mesh.h"
#include "tests/simulator/ground/ground.h"
#include "tests/simulator/ground/ground_canvas.h"
#include "tests/simulator/ground/road_look.h"
#include "tests/simulator/layouts/lot_layout.h"
#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// The asphalt of a car park: worn and patched, with cracks, stains, lines,
/// arrows, manholes and litter here, and large plain areas there. Of `options` the texels, the
/// seed, marks of slots, drains and the season count.
GroundCanvas PaintLot(const LotLayout& layout, const RoadLook& road, const SceneOptions& options);

/// The sealed concrete of a garage's deck that has the plan of a lot, with numbers of slots
/// from 100 * (deck + 1) + 1 on, and `strip` [m] more to the north.
GroundCanvas PaintDeck(const LotLayout& layout, double strip, const SceneOptions& options,
                       int deck);

/// The asphalt as a mesh of quarter-meter steps, the same that the truth is
/// written from. Within 0.2 mm of the ground.
Mesh MakeLotGround(const LotLayout& layout, const Ground& ground);

}  // namespace parkade::simulator

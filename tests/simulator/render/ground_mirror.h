#pragma once

#include "tests/simulator/render/scene_surfaces.h"

namespace parkade::simulator {

/// Sets SurfacePoint::reflected of the lanes that are wet or sealed ground to what they mirror of
/// the world. The samples of a pixel look along slightly unlike directions, as water is not quite
/// even.
void MirrorWorld(const Scene& scene, const SceneSurfaces& surfaces, const PacketPoses& poses,
                 const LaneFlags& is_surface, SurfacePoints& points);

}  // namespace parkade::simulator

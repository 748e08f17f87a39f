#pragma once

#include <filesystem>
#include <span>

#include "core/geo.h"
#include "core/rigid3.h"
#include "core/timestamp.h"
#include "core/triangle_mesh.h"
#include "tests/simulator/ground/kerb_stone.h"
#include "tests/simulator/layouts/place.h"
#include "tests/simulator/motion/motion.h"

namespace parkade::simulator {

/// The drivable ground as a mesh in world, all its levels: squares of 10 cm, without
/// islands and what parked cars stand on.
TriangleMesh DrivableSurface(const Place& place);

/// GeoJSON of the parking slots: outlines in WGS84, and in `properties` their kind, whether a car
/// stands there, and where they are in world: `center` [m], `size` [m] along and across, `yaw`
/// [rad].
void WriteSlots(const Place& place, const SiteDatum& datum, const std::filesystem::path& file);

/// GeoJSON of kerbs, stone by stone: the line of its foot in WGS84, the ground on its left, and in
/// `properties` its type "kerb", `height_m` above that ground, and its `line` in world [m].
void WriteKerbs(std::span<const KerbStone> kerbs, const SiteDatum& datum,
                const std::filesystem::path& file);

/// Binary PLY: float x, y, z [m] and triangles. Whole or not at all.
void WritePly(const TriangleMesh& mesh, const std::filesystem::path& file);

/// `world_from_imu` at 200 Hz from the first to the last moment of the motion.
void WriteTruthTrajectory(const Motion& motion, const Rigid3& body_from_imu, Timestamp epoch,
                          const std::filesystem::path& file);

}  // namespace parkade::simulator

#pragma once

#include "core/rig.h"
#include "tests/simulator/common/fault_options.h"

namespace parkade::simulator {

/// `rig` with the time shifts that its cameras really have.
Rig TrueRig(const Rig& rig, const FaultOptions& faults);

/// What the owner of the car believes of `true_rig`: cameras mounted a little elsewhere, no time
/// shifts.
Rig NominalRig(const Rig& true_rig, const FaultOptions& faults, std::uint64_t seed);

/// The camera after its mirror was turned by `angle_deg` about its hinge.
RigCamera KnockedCamera(const RigCamera& camera, double angle_deg);

}  // namespace parkade::simulator

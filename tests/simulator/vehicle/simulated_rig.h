#pragma once

#include <string>

#include "core/geo.h"
#include "core/rig.h"

namespace parkade::simulator {

/// The own car is a hatchback (see MakeCar).
inline constexpr int kOwnCarStyle = 0;

struct RigOptions {
  int width = 640, height = 400;  ///< [px]
  int num_cameras = 4;            ///< 1..4: front, left, right, rear
  double line_delay = 0;          ///< [s/row] rolling shutter
  std::string lens = "kb";        ///< model of the fisheyes, see LensNames()

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("width", width);
    visit("height", height);
    visit("num_cameras", num_cameras);
    visit("line_delay", line_delay);
    visit("lens", lens);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Half the angle of view of the lenses [rad]; beyond it the image is black.
inline constexpr double kHalfFieldOfView = 94.0 * 3.14159265358979323846 / 180;

/// A car with fisheyes at the front, under both mirrors and at the rear, an IMU
/// of the MEMS kind under the seats, and a GNSS antenna on the roof. No two
/// numbers are round: mounting and lenses scatter with the seed as in real cars.
/// Masks are not set: see OwnCarMask.
Rig MakeSimulatedRig(const RigOptions& options, std::uint64_t seed);

/// Where on the Earth the simulated site lies.
SiteDatum SimulatedDatum();

}  // namespace parkade::simulator

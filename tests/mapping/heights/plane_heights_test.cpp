#include "mapping/heights/plane_heights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

constexpr double kWheelbase = 2.6;  // [m]

/// [m] flat ground, and from x = 0 a ramp of 12 %.
double HeightAt(double x) {
  constexpr double kBend = 3, kSlope = 0.12;  // [m] over which it begins
  if (x < 0) return 0;
  return x < kBend ? 0.5 * kSlope / kBend * x * x : kSlope * (x - 0.5 * kBend);
}

/// A car that stops when it is on the ramp with its front wheels.
DrivenPath PathToARamp() {
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 50; ++i) {
    TrajectoryState state;
    state.time = TimestampFromSeconds(0.1 * i);
    const double x = 0.3 * i - 14, rise = HeightAt(x + kWheelbase) - HeightAt(x);
    state.world_from_body.translation = {x, 0, HeightAt(x)};
    state.world_from_body.rotation =
        Eigen::AngleAxisd(-std::atan(rise / kWheelbase), Eigen::Vector3d::UnitY());
    states.push_back(state);
  }
  DrivenPath path;
  path.site_from_body = Trajectory(std::move(states));
  path.contact = {kWheelbase, 1.6};
  return path;
}

/// What a camera of each third pose calls free, as far as 8 m ahead, on the plane of its car.
std::vector<PosedGroundPatch> PatchesAlong(const DrivenPath& path) {
  std::vector<PosedGroundPatch> patches;
  const std::vector<TrajectoryState>& states = path.site_from_body.states();
  for (size_t i = 1; i < states.size(); i += 3) {
    PosedGroundPatch posed{{.drive = 0, .camera = 0, .time = states[i].time, .samples = {}},
                           states[i].world_from_body};
    for (double x = 0.2; x < 8; x += 0.2)
      for (double y = -2.4; y < 2.5; y += 0.2) {
        GroundSample sample;
        sample.point_in_body = Eigen::Vector3f(Eigen::Vector3d(x, y, 0).cast<float>());
        sample.is_free = true;
        const double beyond = std::max(0.0, x - kWheelbase);
        sample.weight = static_cast<float>(1 / (4e-4 + std::pow(0.0035 * beyond * beyond, 2)));
        posed.patch.samples.push_back(sample);
      }
    patches.push_back(std::move(posed));
  }
  return patches;
}

TEST(PlaneHeights, AreAsSureAsTheyAgree) {
  const DrivenPath path = PathToARamp();
  const std::vector<PosedGroundPatch> patches = PatchesAlong(path);

  double flat = 0, ramp = 1;
  for (const HeightObservation& sum : CollectPlanes(PatchesInMemory(patches), &path, {}).Sums()) {
    const Eigen::Vector3d& point = sum.point_in_site;
    if (point.x() < -1 && point.x() > -8) flat = std::max(flat, sum.sigma);
    if (point.x() > 5 && point.x() < 6) ramp = std::min(ramp, sum.sigma);
  }

  EXPECT_LT(flat, 0.04);
  EXPECT_GT(ramp, 0.1) << "cars before the ramp saw it as flat";
}

}  // namespace
}  // namespace parkade

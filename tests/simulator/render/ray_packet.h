#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <limits>

#include "tests/simulator/rays/row_poses.h"
#include "tests/simulator/rays/sample_table.h"
#include "tests/simulator/render/shading.h"

namespace parkade::simulator {

// One lane a ray: those of four neighboring pixels, in the order of SamplePacket.
using LaneFlags = std::array<bool, kPacketSize>;
using SurfacePoints = std::array<SurfacePoint, kPacketSize>;

/// Where the car is at the moment of each ray.
struct PacketPoses {
  const RowPoses& row;
  std::array<std::uint8_t, kPacketSize> moments{};

  /// For the samples of a pixel from `first` on.
  void SetMoments(int pixel, const PixelMoments& of_pixel, int first) {
    for (int sample = 0; sample < kSamplesPerPixel; ++sample)
      moments[static_cast<size_t>(pixel * kSamplesPerPixel + sample)] = of_pixel.Of(first + sample);
  }
  const MomentPose& Of(int lane) const { return row.moments[moments[static_cast<size_t>(lane)]]; }
};

/// `time`: 0..1 over the image.
inline void SetRay(RTCRay16& rays, int lane, const Eigen::Vector3f& origin,
                   const Eigen::Vector3f& direction, float far, float time) {
  rays.org_x[lane] = origin.x(), rays.org_y[lane] = origin.y(), rays.org_z[lane] = origin.z();
  rays.dir_x[lane] = direction.x(), rays.dir_y[lane] = direction.y(),
  rays.dir_z[lane] = direction.z();
  rays.tnear[lane] = 0, rays.tfar[lane] = far, rays.time[lane] = time;
  rays.mask[lane] = ~0u, rays.id[lane] = static_cast<unsigned>(lane), rays.flags[lane] = 0;
}

/// Empties the rays of lanes that are not valid. Embree splits packets that are wider than the
/// processor's registers, and then knows such lanes by their interval alone.
inline void EmptyOtherLanes(const int* valid, RTCRay16& rays) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (int lane = 0; lane < static_cast<int>(kPacketSize); ++lane) {
    if (valid[lane]) continue;
    SetRay(rays, lane, Eigen::Vector3f::Zero(), Eigen::Vector3f::UnitZ(), -kInfinity, 0);
    rays.tnear[lane] = kInfinity;
  }
}

/// Marks a lane as one that has met nothing yet.
inline void ClearHit(RTCRayHit16& hits, int lane) {
  hits.hit.geomID[lane] = hits.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

inline Eigen::Vector3f DirectionOf(const RTCRay16& rays, int lane) {
  return {rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]};
}

}  // namespace parkade::simulator

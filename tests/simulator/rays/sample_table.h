#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/rig.h"
#include "tests/simulator/common/mesh.h"
#include "tests/simulator/common/sample_pattern.h"
#include "tests/simulator/rays/ray_scene.h"

namespace parkade::simulator {

inline constexpr int kPixelsPerPacket = 4;
inline constexpr int kPacketSize = kSamplesPerPixel * kPixelsPerPacket;

/// The rays of four pixels, four each; lane = 4 * pixel + sample. In a SampleTable the pixels are
/// neighbors and the samples their first four.
struct alignas(64) SamplePacket {
  float x[kPacketSize], y[kPacketSize], z[kPacketSize];  ///< unit direction in camera
  std::int32_t target[kPacketSize];  ///< kOutside, kWorld, or an index into own_car_hits
};
inline constexpr std::int32_t kOutside = -2, kWorld = -1;

/// Where a ray meets the own car.
struct OwnCarHit {
  Eigen::Vector3f point_in_body, normal_in_body;
  float distance = 0;  ///< [m]
  MaterialId material = 0;
};

/// All that is the same in every image of one camera: the rays of its pixels,
/// and which of them end on the car itself. About 64 bytes a sample.
struct SampleTable {
  int width = 0, height = 0;
  int packets_per_row = 0;
  std::vector<SamplePacket> packets;  ///< row by row
  std::vector<float> sample_angle;    ///< [rad] between neighboring samples, per pixel
  std::vector<float> vignetting;      ///< share of light that arrives, per pixel
  std::vector<OwnCarHit> own_car_hits;

  /// The packet with a pixel; in it the pixel is number column % kPixelsPerPacket.
  const SamplePacket& PacketOf(int column, int row) const {
    return packets[static_cast<size_t>(row * packets_per_row + column / kPixelsPerPacket)];
  }
  float SampleAngle(int column, int row) const {
    return sample_angle[static_cast<size_t>(row * width + column)];
  }
  float Vignetting(int column, int row) const {
    return vignetting[static_cast<size_t>(row * width + column)];
  }

  /// CV_8UC1, 0 where a pixel shows the own car or the outside of the lens.
  cv::Mat Mask() const;
};

/// `own_car_rays` holds `own_car` alone, in body.
SampleTable MakeSampleTable(const RigCamera& camera, const Mesh& own_car,
                            const RayScene& own_car_rays, double half_field_of_view);

}  // namespace parkade::simulator

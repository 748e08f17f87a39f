#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/rigid3.h"
#include "core/surface_class.h"
#include "core/timestamp.h"

namespace parkade {

/// A point near a car in six bytes: to 0.5 mm across, within 32 m, and to 0.1 mm in height,
/// within 6.5 m.
class CompactPoint {
 public:
  CompactPoint() = default;
  CompactPoint(const Eigen::Vector3f& point)  // NOLINT: converts
      : x_(Step(point.x(), kAcross)), y_(Step(point.y(), kAcross)), z_(Step(point.z(), kUp)) {}

  float x() const { return kAcross * static_cast<float>(x_); }
  float y() const { return kAcross * static_cast<float>(y_); }
  float z() const { return kUp * static_cast<float>(z_); }
  operator Eigen::Vector3f() const { return {x(), y(), z()}; }  // NOLINT: converts
  template <typename Scalar>
  Eigen::Matrix<Scalar, 3, 1> cast() const {
    return Eigen::Vector3f(*this).cast<Scalar>();
  }
  float norm() const { return Eigen::Vector3f(*this).norm(); }

 private:
  static constexpr float kAcross = 0.001F, kUp = 0.0002F;  // [m]
  static std::int16_t Step(float value, float step) {
    return static_cast<std::int16_t>(std::lround(std::clamp(value / step, -32767.0F, 32767.0F)));
  }

  std::int16_t x_ = 0, y_ = 0, z_ = 0;
};

/// A number in two bytes, to 0.4 % of itself.
class CompactFloat {
 public:
  CompactFloat() = default;
  CompactFloat(float value)  // NOLINT: converts
      : upper_(static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0x8000U) >> 16U)) {
  }
  // NOLINTNEXTLINE(google-explicit-constructor): converts
  operator float() const { return std::bit_cast<float>(std::uint32_t{upper_} << 16U); }

 private:
  std::uint16_t upper_ = 0;
};

/// One sample of the ground as one keyframe saw it. Small: a drive keeps tens of millions per
/// kilometer.
struct GroundSample {
  CompactPoint point_in_body;  ///< [m]
  std::uint8_t blue = 0, green = 0, red = 0;
  bool is_free : 1 = false;  ///< drivable ground; false: seen, and not ground
  SurfaceClass surface : 7 = SurfaceClass::kUnknown;  // all bits that are left
  CompactFloat weight = 1;                            ///< inverse variance of the height [1/m^2]
  CompactFloat footprint = 0;  ///< [m] side of the square of ground that it stands for; 0: one cell
  CompactFloat confidence =
      1;  ///< of is_free, 0 to 1: the share of a sure observation's log-odds that this one counts
          ///< for. 0: it only has a color, because it lies beyond what bounds the ground or, where
          ///< is_free, nothing can be told

  bool IsDoubtful() const { return is_free && confidence <= 0; }
  bool IsBeyond() const { return !is_free && confidence <= 0; }
};
static_assert(sizeof(GroundSample) == 16);

/// What one keyframe of one camera saw of the ground. Kept in body, so that it
/// is fused again whenever poses change.
struct GroundPatch {
  int drive = 0;
  int camera = 0;
  Timestamp time;
  std::vector<GroundSample> samples;
};

/// A patch with the pose of its body in the site.
struct PosedGroundPatch {
  GroundPatch patch;
  Rigid3 site_from_body;
};

}  // namespace parkade

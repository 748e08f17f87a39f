#include "mapping/meet_surface.h"

#include <cmath>

namespace parkade {
namespace {

constexpr int kMaxRounds = 4;          // fixed-point rounds of ray and surface
constexpr double kTolerance = 0.0025;  // [m] of height at which they have met
constexpr double kMaxStretch = 1.5;    // of a ray: beyond, the view is too grazing to trust

}  // namespace

int MeetSurface(const HeightField& field, const Eigen::Vector3d& eye, Eigen::Vector3d& point) {
  const Eigen::Vector3d ray = point - eye;
  for (int round = 0; round < kMaxRounds; ++round) {
    double height = 0;
    const int patch = field.FindPatch(point, height);
    if (patch == HeightField::kNone) return HeightField::kNone;
    if (std::abs(height - point.z()) < kTolerance) return patch;
    const double stretch = (height - eye.z()) / ray.z();
    if (!(stretch > 0.1 && stretch < kMaxStretch)) return HeightField::kNone;
    point = eye + stretch * ray;
  }
  return field.FindPatch(point);
}

}  // namespace parkade

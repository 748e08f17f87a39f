#include "mapping/heights/intersect_ray.h"

#include <cmath>

namespace parkade {
namespace {

constexpr int kMaxRounds = 5;          // of ray and surface
constexpr double kTolerance = 0.0025;  // [m] of height at which they have met
constexpr double kNotMet = 0.02;       // [m] off after all rounds: the view cannot be trusted
constexpr double kMaxStretch = 1.5;    // of a ray: beyond, the view is too grazing to trust
constexpr double kLookStep = 0.8;      // [m] between places where something may stand in the way

}  // namespace

int IntersectRay(PatchFinder& patches, const Eigen::Vector3d& eye, Eigen::Vector3d& point) {
  const Eigen::Vector3d ray = point - eye;
  double stretch = 1, last_stretch = 1, last_gap = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    double height = 0;
    const int patch = patches.Find(point, height);
    if (patch == HeightField::kNone) return HeightField::kNone;
    const double gap = height - point.z();
    if (std::abs(gap) < kTolerance) return patch;
    // First as if the ground were level there; then by the secant, since a ramp may rise faster
    // than the ray falls.
    const double next = round == 0 ? (height - eye.z()) / ray.z()
                                   : stretch - gap * (stretch - last_stretch) / (gap - last_gap);
    if (!(next > 0.1 && next < kMaxStretch)) return HeightField::kNone;
    last_stretch = stretch, last_gap = gap, stretch = next;
    point = eye + stretch * ray;
  }
  double height = 0;
  const int patch = patches.Find(point, height);
  return patch != HeightField::kNone && std::abs(height - point.z()) < kNotMet ? patch
                                                                               : HeightField::kNone;
}

bool IsHidden(const HeightField& field, const Eigen::Vector3d& eye, const Eigen::Vector3d& point) {
  const Eigen::Vector3d ray = point - eye;
  const double length = ray.head<2>().norm();
  for (double along = kLookMargin; along < length - kLookMargin; along += kLookStep) {
    const Eigen::Vector3d place = eye + along / length * ray;
    double height = 0;
    const int patch = field.FindPatch(place, height);
    if (patch != HeightField::kNone && height > place.z() + kHidingHeight && height < eye.z() &&
        field.SigmaOf(patch) <= kHidingSigma)
      return true;
  }
  return false;
}

}  // namespace parkade

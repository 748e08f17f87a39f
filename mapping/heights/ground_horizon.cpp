#include "mapping/heights/ground_horizon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mapping/heights/intersect_ray.h"

namespace parkade {
namespace {

constexpr int kNumSectors = 64;     // of a turn
constexpr double kRingWidth = 0.8;  // [m]
constexpr double kNothing = -std::numeric_limits<double>::infinity();

/// Grows with the angle from -x around to -x again, from 0 to kNumSectors: cheaper than an angle.
double SectorAt(const Eigen::Vector2d& ray) {
  const double along = ray.x() / (std::abs(ray.x()) + std::abs(ray.y()));
  return (ray.y() < 0 ? 1 + along : 3 - along) * (kNumSectors / 4);
}

}  // namespace

GroundHorizon::GroundHorizon(const HeightField& field, const Eigen::Vector3d& eye,
                             const Eigen::AlignedBox2d& box)
    : eye_(eye), num_rings_(0) {
  if (box.isEmpty()) return;
  const Eigen::Vector2d farthest =
      (box.min() - eye.head<2>()).cwiseAbs().cwiseMax((box.max() - eye.head<2>()).cwiseAbs());
  num_rings_ = RingOf(farthest.norm()) + 1;
  slopes_.assign(static_cast<size_t>(kNumSectors * num_rings_), kNothing);
  struct Square {
    int patch = 0;
    double top = 0;  // [m]
  };
  std::vector<Square> squares;
  double lowest = eye.z();
  field.VisitPatches(box, [&](int patch, double low, double high) {
    lowest = std::min(lowest, low);
    if (low < eye.z()) squares.push_back({patch, std::min(high, eye.z()) - kHidingHeight});
  });
  for (const auto& [patch, top] : squares) {
    if (top <= lowest || field.SigmaOf(patch) > kHidingSigma) continue;  // too low to hide anything
    const Eigen::Vector2d corner = field.spacing() * field.IndexOf(patch).cast<double>();
    Raise({corner, (corner.array() + field.spacing()).matrix()}, top);
  }
  for (int sector = 0; sector < kNumSectors; ++sector) {
    const auto begin = slopes_.begin() + sector * num_rings_;
    for (int ring = 1; ring < num_rings_; ++ring)
      begin[ring] = std::max(begin[ring - 1], begin[ring]);
  }
}

int GroundHorizon::RingOf(double distance) { return static_cast<int>(distance / kRingWidth); }

/// What stands on a square may be at its near or its far side: a bound from above.
void GroundHorizon::Raise(const Eigen::AlignedBox2d& square, double height) {
  const Eigen::Vector2d eye = eye_.head<2>();
  const double nearest = square.exteriorDistance(eye);
  const double farthest =
      (square.min() - eye).cwiseAbs().cwiseMax((square.max() - eye).cwiseAbs()).norm();
  if (farthest < kLookMargin) return;
  double first = 0, last = kNumSectors - 1;
  if (nearest > 0) {
    std::array<double, 4> sectors{};
    for (int i = 0; i < 4; ++i)
      sectors[static_cast<size_t>(i)] =
          SectorAt(square.corner(static_cast<Eigen::AlignedBox2d::CornerType>(i)) - eye);
    const auto [low, high] = std::minmax_element(sectors.begin(), sectors.end());
    first = *low, last = *high;
    if (last - first > kNumSectors / 2) {  // across -x
      first = kNumSectors, last = 0;
      for (const double sector : sectors)
        if (sector < kNumSectors / 2)
          last = std::max(last, sector + kNumSectors);
        else
          first = std::min(first, sector);
    }
  }
  const double slope =
      (height - eye_.z()) / farthest;  // below the eye: the farther, the less steep
  const int ring = RingOf(nearest);
  for (int sector = static_cast<int>(first); sector <= static_cast<int>(last); ++sector) {
    double& highest = slopes_[static_cast<size_t>(sector % kNumSectors * num_rings_ + ring)];
    highest = std::max(highest, slope);
  }
}

bool GroundHorizon::MayHide(const Eigen::Vector3d& point_in_site) const {
  const Eigen::Vector3d ray = point_in_site - eye_;
  const double length = ray.head<2>().norm(), before = length - kLookMargin;
  if (before <= kLookMargin || num_rings_ == 0) return false;
  const int sector = static_cast<int>(SectorAt(ray.head<2>())) % kNumSectors;
  const int ring = std::min(RingOf(before), num_rings_ - 1);
  return ray.z() / length < slopes_[static_cast<size_t>(sector * num_rings_ + ring)];
}

}  // namespace parkade

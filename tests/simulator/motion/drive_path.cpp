#include "tests/simulator/motion/drive_path.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace parkade::simulator {

DrivePath::DrivePath(std::vector<Leg> legs) : legs_(std::move(legs)) {
  Require(!legs_.empty(), ErrorCode::kInternal, "a drive needs a leg");
  double heading = legs_.front().route.Heading(0) + (legs_.front().is_reverse ? M_PI : 0);
  for (const Leg& leg : legs_) {
    const double turned = leg.route.Heading(0) + (leg.is_reverse ? M_PI : 0);
    turns_.push_back((leg.is_reverse ? M_PI : 0) +
                     2 * M_PI * std::round((heading - turned) / (2 * M_PI)));
    heading = leg.route.Heading(leg.route.Length()) + turns_.back();
  }
}

double DrivePath::Length() const {
  double length = 0;
  for (const Leg& leg : legs_) length += leg.route.Length();
  return length;
}

double DrivePath::MinRadius() const {
  double max_curvature = 1e-9;
  for (const Leg& leg : legs_)
    for (double s = 0; s < leg.route.Length(); s += 0.05)
      max_curvature = std::max(max_curvature, std::abs(leg.route.Curvature(s)));
  return 1 / max_curvature;
}

PathPoint DrivePath::At(size_t leg, double distance) const {
  const Route& route = legs_[leg].route;
  return {.position = route.Position(distance),
          .near_z = route.HeightHint(distance),
          .heading = route.Heading(distance) + turns_[leg],
          .curvature = route.Curvature(distance) * (legs_[leg].is_reverse ? -1 : 1)};
}

}  // namespace parkade::simulator

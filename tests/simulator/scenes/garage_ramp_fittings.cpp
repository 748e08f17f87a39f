#include <cmath>

#include "tests/simulator/scenes/garage_structure.h"

namespace parkade::simulator {

using Eigen::Vector3d;

void GarageStructure::RampLamps(int deck) {
  const double floor = deck * layout_.storey;
  for (const double share : {0.2, 0.5, 0.8}) {
    const double along = share * layout_.straight.run;
    TubeLamp({layout_.ramp_from + along, layout_.width + GarageLayout::kStrip - 0.3,
              floor + layout_.straight.Height(along) + 2.15},
             0);
  }
  for (const double share : {0.15, 0.5, 0.85}) {
    const double angle = M_PI * (share - 0.5),
                 radius = layout_.curve_radius + GarageLayout::kCurveHalfWidth - 0.3;
    TubeLamp({layout_.length + radius * std::cos(angle), layout_.curve_y + radius * std::sin(angle),
              floor + layout_.curve.Height(share * layout_.curve.run) + 2.15},
             angle + M_PI / 2);
  }
}

void GarageStructure::AddToCurve(const CurvePlace& place, const Vector3d& half_size,
                                 MaterialId material) {
  const double radius =
      layout_.curve_radius + (place.is_outer ? 1 : -1) * GarageLayout::kCurveHalfWidth;
  const double floor = place.deck * layout_.storey +
                       layout_.curve.Height((place.angle + M_PI / 2) * layout_.curve_radius);
  mesh_.AddBox({layout_.length + radius * std::cos(place.angle),
                layout_.curve_y + radius * std::sin(place.angle), floor + place.height},
               half_size, place.angle, material);
}

void GarageStructure::CurveWall(int deck, bool is_outer) {
  const double radius = layout_.curve_radius + (is_outer ? 1 : -1) * GarageLayout::kCurveHalfWidth;
  const auto anywhere = [&] { return random_.Uniform(-1.5, 1.5); };  // [rad]
  // Paint at the foot, in strips as a roller leaves them.
  const double strip = 0.5 / radius;
  for (double angle = -M_PI / 2 + strip / 2; angle < M_PI / 2; angle += strip)
    AddToCurve({deck, is_outer, angle, 0.4}, {0.012, 0.26, 0.4 + random_.Uniform(0, 0.02)}, paint_);
  // What bumpers, mirrors and tires leave.
  const int num_scuffs = static_cast<int>(9 * radius);
  for (int i = 0; i < num_scuffs; ++i) {
    const MaterialId materials[] = {rubber_, paper_, concrete_, black_};
    AddToCurve({deck, is_outer, anywhere(), random_.Uniform(0.15, 1.1)},
               {0.02 + 0.0001 * i, random_.Uniform(0.03, 0.3), random_.Uniform(0.006, 0.03)},
               materials[random_.Index(4)]);
  }
  // Boards that show the bend, and what hangs on walls otherwise.
  for (double angle = -1.3; angle < 1.4; angle += random_.Uniform(2, 4) / radius) {
    if (random_.Chance(0.4)) {
      for (int part = -2; part <= 2; ++part)
        AddToCurve({deck, is_outer, angle + 0.12 * part / radius, 1.35}, {0.025, 0.06, 0.2},
                   part % 2 == 0 ? black_ : yellow_);
    } else {
      AddToCurve({deck, is_outer, angle, random_.Uniform(1.2, 1.7)},
                 {0.03, random_.Uniform(0.1, 0.25), random_.Uniform(0.12, 0.3)},
                 random_.Chance(0.5) ? metal_ : paper_);
    }
  }
}

void GarageStructure::RampWall(int deck, bool is_north) {
  const double y = layout_.width + (is_north ? GarageLayout::kStrip - 0.1 : 0.1);
  // The flat ends of the way as well, on this deck and on the next.
  const double begin = 9.5 - layout_.ramp_from, end = layout_.length - 9.5 - layout_.ramp_from;
  const auto add = [&](double along, double height, const Vector3d& half_size,
                       MaterialId material) {
    const double floor = deck * layout_.storey + layout_.straight.Height(along);
    mesh_.AddBox({layout_.ramp_from + along, y, floor + height}, half_size, 0, material);
  };
  const double paint_half = layout_.style.paint_height / 2;
  for (double along = begin; along < end; along += 0.55)
    add(along, paint_half, {0.28, 0.012, paint_half + random_.Uniform(0, 0.02)}, paint_);
  const int num_scuffs = static_cast<int>(9 * (end - begin));
  for (int i = 0; i < num_scuffs; ++i) {
    const MaterialId materials[] = {rubber_, paper_, concrete_, black_};
    add(random_.Uniform(begin, end), random_.Uniform(0.1, 1.9),
        {random_.Uniform(0.03, 0.3), 0.02 + 0.0001 * i, random_.Uniform(0.006, 0.04)},
        materials[random_.Index(4)]);
  }
  for (double along = begin + random_.Uniform(0.5, 2); along < end;
       along += random_.Uniform(1.5, 3.5))
    add(along, random_.Uniform(1.2, 1.7),
        {random_.Uniform(0.1, 0.3), 0.06, random_.Uniform(0.1, 0.3)},
        random_.Chance(0.5) ? metal_ : paper_);
}

}  // namespace parkade::simulator

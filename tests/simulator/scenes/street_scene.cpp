#include "tests/simulator/scenes/street_scene.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/ground/ground_painter.h"
#include "tests/simulator/ground/season.h"
#include "tests/simulator/layouts/props.h"
#include "tests/simulator/layouts/slot_marks.h"
#include "tests/simulator/layouts/street_layout.h"
#include "tests/simulator/layouts/street_place.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Lines of lanes, crossings and arrows along one street, and of parking strips where slots have no
/// marks.
void MarkStreet(const StreetLayout& layout, const RoadField::Line& line, SlotMarks marks,
                GroundPainter& painter) {
  for (size_t i = 2; i + 3 < line.size(); ++i) {
    const Vector2d along = (line[i + 1] - line[i]).normalized(), left(-along.y(), along.x());
    const auto is_near = [&](const Vector2d& place, double reach) {
      return (place - line[i]).norm() < reach;
    };
    const bool is_junction =
        is_near(layout.south_junction, 13) || is_near(layout.north_junction, 13);
    bool is_crossing = false;
    for (const Rectangle& crossing : layout.crossings)
      is_crossing = is_crossing || is_near(crossing.center, 4);
    if (is_junction || is_crossing) continue;
    if (i % 9 < 4) painter.Line(line[i], line[i + 1], 0.12, 0.3f);
    if (i % 2 == 0 && marks == SlotMarks::kUsual)
      for (const double side : {-3.3, 3.3})
        painter.Line(line[i] + side * left, line[i] + side * left + 0.8 * along, 0.1, 0.4f);
    if (i % 67 == 30) {
      painter.Arrow(line[i] - StreetLayout::kLane * left, std::atan2(along.y(), along.x()));
      painter.Arrow(line[i] + StreetLayout::kLane * left, std::atan2(-along.y(), -along.x()));
    }
  }
}

/// Grates before the kerbs of both sides, and a gutter across here and there.
void AddDrains(const StreetLayout& layout, GroundPainter& painter) {
  Random& random = painter.random();
  for (const RoadField::Line* line : {&layout.loop, &layout.cross}) {
    for (double place = 3; place + 3 < static_cast<double>(line->size());
         place += random.Uniform(7, 13)) {
      const size_t index = static_cast<size_t>(place);
      const Vector2d along = ((*line)[index + 1] - (*line)[index]).normalized(),
                     left(-along.y(), along.x());
      for (const double side : {-1.0, 1.0}) {
        const Vector2d at = (*line)[index] + side * (StreetLayout::kHalfWidth - 0.25) * left;
        if (layout.field.At(at) > -1) painter.Drain(at, std::atan2(along.y(), along.x()));
      }
      if (random.Chance(0.12)) painter.Gutter((*line)[index] - 5 * left, (*line)[index] + 5 * left);
    }
  }
}

GroundCanvas PaintStreet(const StreetLayout& layout, const RoadLook& road,
                         const SceneOptions& options) {
  constexpr double kCoarser = 2.5;  // than a lot's: a street is long
  const SlotMarks marks = SlotMarksOf(options.slot_marks);
  const Vector2d min = layout.field.min(), max = layout.field.max();
  GroundCanvas canvas(min, max, kCoarser * options.ground_texel);
  GroundPainter painter(max - min, canvas, options.seed);
  painter.Asphalt(road, [&](float x, float y) { return layout.field.At({x, y}) < 0.4; });
  Random& random = painter.random();
  const auto anywhere = [&] {
    const auto& line = random.Chance(0.85) ? layout.loop : layout.cross;
    return Vector2d(line[static_cast<size_t>(random.Index(static_cast<int>(line.size())))] +
                    Vector2d(random.Uniform(-5, 5), random.Uniform(-5, 5)));
  };
  painter.Patches(150, anywhere);
  painter.Cracks(260, anywhere);
  painter.Stains(500, anywhere, anywhere);
  MarkStreet(layout, layout.loop, marks, painter);
  MarkStreet(layout, layout.cross, marks, painter);
  for (const Rectangle& slot : layout.slots)
    MarkSlot(slot, {std::sin(slot.yaw), -std::cos(slot.yaw)}, marks, painter);
  for (const Rectangle& crossing : layout.crossings) {
    const Vector2d along(std::cos(crossing.yaw), std::sin(crossing.yaw)),
        left(-along.y(), along.x());
    for (double side = -4.8; side < 5; side += 1)
      painter.Line(crossing.center + side * left - 1.5 * along,
                   crossing.center + side * left + 1.5 * along, 0.5, 0.3f);
  }
  for (int i = 0; i < 40; ++i) painter.Manhole(anywhere());
  painter.Litter(9000, anywhere);
  if (options.has_drains) AddDrains(layout, painter);
  LaySeason(
      SeasonOf(options.season), [&](const Vector2d& at) { return -layout.field.At(at); }, painter);
  canvas.Finish();
  return canvas;
}

Mesh MakeRoad(const StreetLayout& layout, const Ground& ground) {
  const RoadField& field = layout.field;
  Mesh mesh;
  const auto vertex = [&](int column, int row) -> Vector3d {
    const Vector2d xy = field.Place(column, row);
    return {xy.x(), xy.y(), ground.Height(xy, 0)};
  };
  mesh.AddPatchedSheet(field.columns(), field.rows(), vertex, [&](int i, int j) {
    return field.AtNode(i, j) < 0.6 || field.AtNode(i + 1, j + 1) < 0.6
               ? std::optional<MaterialId>(0)
               : std::nullopt;
  });
  return mesh;
}

class StreetFurnisher {
 public:
  StreetFurnisher(const StreetLayout& layout, Props& props)
      : layout_(layout), field_(layout.field), props_(props) {}

  /// Pavements behind the kerbs, lawn behind them.
  void Land() {
    for (const auto& [from, to] : field_.Kerbs()) props_.Kerb(from, to);
    constexpr double kInner = 0.13;  // [m] behind the front of the kerb
    const auto vertex = [&](int column, int row) -> Vector3d {
      Vector2d xy = field_.Place(column, row);
      const double away = field_.AtNode(column, row);
      if (std::abs(away) < 0.8 && away < kInner) xy += (kInner - away) * field_.Gradient(xy);
      return props_.OnGreen(xy.x(), xy.y());
    };
    props_.mesh().AddPatchedSheet(field_.columns(), field_.rows(), vertex, [&](int i, int j) {
      double low = 1e9, high = -1e9;
      for (const int di : {0, 1})
        for (const int dj : {0, 1}) {
          low = std::min(low, field_.AtNode(i + di, j + dj));
          high = std::max(high, field_.AtNode(i + di, j + dj));
        }
      const bool is_pavement = low > -0.75 && high > kInner && low < StreetLayout::kPavement;
      return is_pavement ? std::optional<MaterialId>(props_.pavement()) : std::nullopt;
    });
    constexpr double kStep = 4;
    for (double x = field_.min().x() - 100; x < field_.max().x() + 100; x += kStep)
      for (double y = field_.min().y() - 100; y < field_.max().y() + 100; y += kStep) {
        const auto at = [&](double dx, double dy) -> Vector3d {
          return props_.OnGround(x + dx, y + dy, 0.07);
        };
        double low = 1e9;
        for (const double dx : {0.0, kStep / 2, kStep})
          for (const double dy : {0.0, kStep / 2, kStep})
            low = std::min(low, field_.At({x + dx, y + dy}));
        if (low > 0.5)
          props_.mesh().AddQuad({at(0, 0), at(kStep, 0), at(kStep, kStep), at(0, kStep)},
                                props_.land());
      }
  }

  /// Rows of houses on both sides of a street, where they stand on nobody's road.
  void Houses(const RoadField::Line& line) {
    for (const double side : {-1.0, 1.0}) {
      for (double place = 3; place < static_cast<double>(line.size()) - 20;) {
        Random& random = props_.random();
        const double half_front = random.Uniform(4.5, 9), half_depth = random.Uniform(4, 6),
                     gap = random.Uniform(0, 2.5), height = random.Uniform(6, 15);
        const size_t first = static_cast<size_t>(place),
                     last = static_cast<size_t>(place + 2 * half_front);
        if (last >= line.size()) break;
        const Vector2d along = (line[last] - line[first]).normalized(), left(-along.y(), along.x());
        const double front =
            StreetLayout::kHalfWidth + StreetLayout::kPavement + random.Uniform(0.1, 0.9);
        const Rectangle outline{(line[first] + line[last]) / 2 + side * (front + half_depth) * left,
                                {half_front, half_depth},
                                std::atan2(along.y(), along.x())};
        if (IsFree(outline)) {
          props_.Building(outline, height, true);
          houses_.push_back(outline);
          place += 2 * half_front + gap;
        } else {
          place += 3;
        }
      }
    }
  }

  /// Trees, lamps, signs, bins and bollards on the pavement.
  void Pavement(const RoadField::Line& line) {
    Random& random = props_.random();
    for (const double side : {-1.0, 1.0}) {
      for (double place = 4; place < static_cast<double>(line.size()) - 4;
           place += random.Uniform(4, 9)) {
        const size_t index = static_cast<size_t>(place);
        const Vector2d along = (line[index + 1] - line[index]).normalized(),
                       left(-along.y(), along.x());
        const Vector2d at = line[index] + side * (StreetLayout::kHalfWidth + 0.75) * left;
        const int kind = random.Index(10);
        const double size = random.Uniform(4.5, 7.5);
        bool is_kept = std::abs(field_.At(at) - 0.75) < 0.3;
        for (const Rectangle& crossing : layout_.crossings)
          is_kept = is_kept && (crossing.center - at).norm() > 8;
        if (!is_kept) continue;
        if (kind < 4) props_.Tree(at, size);
        if (kind >= 4 && kind < 6) props_.StreetLamp(at);
        if (kind == 6) props_.Sign(at, std::atan2(along.y(), along.x()) + (side > 0 ? 0 : M_PI));
        if (kind == 7) props_.Bin(at + 0.2 * side * left);
        if (kind > 7)
          for (int i = 0; i < 3; ++i) props_.Bollard(at + 1.5 * i * along - 0.3 * side * left);
      }
    }
    for (const Rectangle& crossing : layout_.crossings)
      for (const double side : {-1.0, 1.0}) {
        const Vector2d along(std::cos(crossing.yaw), std::sin(crossing.yaw)),
            left(-along.y(), along.x());
        props_.Sign(
            crossing.center + side * (2.4 * along + (StreetLayout::kHalfWidth + 0.5) * left),
            crossing.yaw + (side > 0 ? 0 : M_PI));
      }
  }

  void Gardens() {
    Random& random = props_.random();
    for (int i = 0; i < 160; ++i) {
      const Vector2d at(random.Uniform(field_.min().x(), field_.max().x()),
                        random.Uniform(field_.min().y(), field_.max().y()));
      const double size = random.Uniform(4, 9);
      const bool is_in_house =
          std::any_of(houses_.begin(), houses_.end(),
                      [&](const Rectangle& house) { return house.SignedDistance(at) < 2; });
      if (field_.At(at) > 5 && !is_in_house) props_.Tree(at, size);
    }
  }

 private:
  bool IsFree(const Rectangle& outline) const {
    for (const double u : {-1.0, -0.5, 0.0, 0.5, 1.0})
      for (const double v : {-1.0, 0.0, 1.0}) {
        const double c = std::cos(outline.yaw), s = std::sin(outline.yaw),
                     x = u * outline.half_size.x(), y = v * outline.half_size.y();
        const Vector2d point = outline.center + Vector2d(c * x - s * y, s * x + c * y);
        if (field_.At(point) < StreetLayout::kPavement) return false;
        for (const Rectangle& house : houses_)
          if (house.SignedDistance(point) < 0.3) return false;
      }
    return true;
  }

  const StreetLayout& layout_;
  const RoadField& field_;
  Props& props_;
  std::vector<Rectangle> houses_;
};

}  // namespace

Scene BuildStreet(const SceneOptions& options) {
  const StreetLayout layout = PlanStreet(options.seed, options.day);
  const PlaceLook look = InSeason(LookOf(options.looks, options.seed), SeasonOf(options.season));
  const Weather weather = WeatherOf(options);
  Scene scene{.place = MakeStreetPlace(layout, options),
              .sky = Sky(options.seed + 7919 * static_cast<std::uint64_t>(options.day), weather,
                         options.sun_elevation)};
  scene.ground = MakeRoad(layout, scene.place.ground);
  scene.ground_colors.push_back(PaintStreet(layout, look.road, options));
  Props props(scene.place.ground, options.seed, weather == Weather::kDusk, look, scene.materials);
  StreetFurnisher furnisher(layout, props);
  furnisher.Land();
  furnisher.Houses(layout.loop);
  furnisher.Houses(layout.cross);
  furnisher.Pavement(layout.loop);
  furnisher.Pavement(layout.cross);
  furnisher.Gardens();
  for (const ParkedCar& car : layout.cars) props.Car(car.footprint, 0, car.style, car.seed);
  scene.objects = std::move(props.mesh());
  scene.lamps = LampField(props.lamps());
  scene.kerbs = std::move(props.kerbs());
  return scene;
}

}  // namespace parkade::simulator

#include "tests/simulator/scenes/garage_scene.h"

#include <cmath>

#include "tests/simulator/ground/ground_painter.h"
#include "tests/simulator/layouts/garage_layout.h"
#include "tests/simulator/layouts/garage_place.h"
#include "tests/simulator/layouts/lot_ground.h"
#include "tests/simulator/layouts/props.h"
#include "tests/simulator/scenes/garage_structure.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// What drips and rolls leave on a ramp.
void Soil(GroundPainter& painter, const GroundPainter::Chooser& anywhere) {
  painter.Cracks(8, anywhere);
  painter.Stains(40, anywhere, anywhere);
  painter.Litter(60, anywhere);
}

/// The canvas of a straight ramp: ribbed concrete between yellow lines.
GroundCanvas PaintStraightRamp(const GarageLayout& layout, const GroundSheet& sheet, double texel,
                               std::uint64_t seed) {
  GroundCanvas canvas(sheet.min, sheet.max, texel);
  GroundPainter painter(sheet.max - sheet.min, canvas, seed);
  painter.Ribbed([](float x, float) { return x; });
  for (const double y : {sheet.min.y() + 0.35, sheet.max.y() - 0.35})
    painter.Line({sheet.min.x(), y}, {sheet.max.x(), y}, 0.12, 0.3f, kYellowPaint);
  const double middle = (sheet.min.y() + sheet.max.y()) / 2;
  for (const double side : {-0.75, 0.75})
    painter.TireTrack({sheet.min.x(), middle + side}, {sheet.max.x(), middle + side}, 0.6, 0.4f);
  Soil(painter, [&]() -> Vector2d { return sheet.min + painter.Anywhere(); });
  for (const double share : {0.25, 0.6})
    painter.Arrow({sheet.min.x() + share * (sheet.max.x() - sheet.min.x()), middle},
                  layout.is_counter ? 0 : M_PI);
  canvas.Finish();
  return canvas;
}

/// The canvas of a half circle: its grooves run from wall to wall.
GroundCanvas PaintCurve(const GarageLayout& layout, const GroundSheet& sheet, double texel,
                        std::uint64_t seed) {
  GroundCanvas canvas(sheet.min, sheet.max, texel);
  GroundPainter painter(sheet.max - sheet.min, canvas, seed);
  const Vector2d center(layout.length, layout.curve_y);
  const double radius = layout.curve_radius, half = GarageLayout::kCurveHalfWidth;
  painter.Ribbed([&](float x, float y) {
    return static_cast<float>(radius * std::atan2(y - center.y(), x - center.x()));
  });
  for (const double side : {0.35 - half, half - 0.35})
    painter.Circle(center, radius + side, 0.12, 0.3f, kYellowPaint);
  for (const double side : {-0.75, 0.75}) painter.TireCircle(center, radius + side, 0.6, 0.4f);
  const auto on_ring = [&](double angle, double aside) -> Vector2d {
    return center + (radius + aside) * Vector2d(std::cos(angle), std::sin(angle));
  };
  Soil(painter, [&] {
    return on_ring(painter.random().Uniform(-M_PI / 2, M_PI / 2),
                   painter.random().Uniform(-half, half));
  });
  for (const double angle : {-0.9, 0.3})
    painter.Arrow(on_ring(angle, 0), angle + (layout.is_counter ? -M_PI / 2 : M_PI / 2));
  canvas.Finish();
  return canvas;
}

GroundCanvas PaintForecourt(const GroundSheet& sheet, double texel, std::uint64_t seed) {
  GroundCanvas canvas(sheet.min, sheet.max, texel);
  GroundPainter painter({1, 1}, canvas, seed);
  painter.Asphalt({});
  const auto anywhere = [&] {
    return Vector2d(painter.random().Uniform(sheet.min.x(), 0),
                    painter.random().Uniform(0, sheet.max.y()));
  };
  painter.Stains(90, anywhere);
  for (int i = 0; i < 4; ++i) painter.Manhole(anywhere());
  for (double y = 3; y < sheet.max.y(); y += 5.5) painter.Line({-29, y}, {-25, y}, 0.12, 0.3f);
  for (double x = -26; x < -2; x += 3)
    painter.Line({x, sheet.max.y() / 2}, {x + 1.5, sheet.max.y() / 2}, 0.12, 0.4f);
  canvas.Finish();
  return canvas;
}

Mesh MakeFloors(const GarageLayout& layout, const Ground& ground) {
  Mesh mesh;
  const auto flat = [&](const Vector2d& low, const Vector2d& high, double step, size_t sheet) {
    const int columns = 2 + static_cast<int>((high.x() - low.x()) / step),
              rows = 2 + static_cast<int>((high.y() - low.y()) / 0.4);
    mesh.AddSheet(
        columns, rows,
        [&](int i, int j) -> Vector3d {
          const Vector2d xy(low.x() + (high.x() - low.x()) * i / (columns - 1.0),
                            low.y() + (high.y() - low.y()) * j / (rows - 1.0));
          return {xy.x(), xy.y(), ground.sheets()[sheet].height(xy)};
        },
        [&](int, int) { return static_cast<MaterialId>(sheet); });
  };
  const double north = layout.width + GarageLayout::kStrip;
  for (size_t deck = 0; deck < layout.decks.size(); ++deck) {
    flat({0, 0}, {layout.length, layout.width}, 0.4, deck);
    flat({0, layout.width}, {layout.ramp_from, north}, 0.4, deck);
    flat({layout.ramp_to, layout.width}, {layout.length, north}, 0.4, deck);
  }
  flat({-GarageLayout::kForecourt, 0}, {0, layout.width}, 0.4, layout.ForecourtSheet());
  for (int deck = 0; deck < layout.num_ramps(); ++deck) {
    const size_t straight = layout.StraightSheet(deck), curve = layout.CurveSheet(deck);
    flat(ground.sheets()[straight].min, ground.sheets()[straight].max, 0.2, straight);
    const int columns = static_cast<int>(layout.curve.run / 0.15), rows = 13;
    mesh.AddSheet(
        columns, rows,
        [&](int i, int j) -> Vector3d {
          const double angle = M_PI * (i / (columns - 1.0) - 0.5),
                       radius = layout.curve_radius -
                                GarageLayout::kCurveHalfWidth * (2 * j / (rows - 1.0) - 1);
          const Vector2d xy = Vector2d(layout.length, layout.curve_y) +
                              radius * Vector2d(std::cos(angle), std::sin(angle));
          return {xy.x(), xy.y(), ground.sheets()[curve].height(xy)};
        },
        [&](int, int) { return static_cast<MaterialId>(curve); });
  }
  return mesh;
}

/// Lawn, trees and houses around the building, as seen from the forecourt and through openings.
void FurnishOutside(const GarageLayout& layout, Props& props) {
  constexpr double kStep = 5;
  const double west = -GarageLayout::kForecourt, north = layout.width + GarageLayout::kStrip + 1;
  for (double x = -160; x < 200; x += kStep)
    for (double y = -120; y < 160; y += kStep) {
      if (x >= west && x < layout.length + 11 && y >= 0 && y + kStep <= north) continue;
      const double x1 = x < west && x + kStep > west && y >= 0 && y < north ? west : x + kStep,
                   z = -0.03;
      props.mesh().AddQuad({Vector3d(x, y, z), {x1, y, z}, {x1, y + kStep, z}, {x, y + kStep, z}},
                           props.land());
    }
  props.Kerb({-0.3, 0}, {west, 0});
  props.Kerb({west, layout.width}, {-0.3, layout.width});
  props.Kerb({west, 0}, {west, layout.width});
  Random& random = props.random();
  for (double y = 2; y < layout.width; y += random.Uniform(5, 9))
    props.Tree({west - 3, y}, random.Uniform(4, 7));
  for (double x = west; x < layout.length; x += random.Uniform(6, 11))
    props.Tree({x, -4}, random.Uniform(4, 8));
  for (double x = west; x < -4; x += 9) props.Tree({x, layout.width + 4}, random.Uniform(4, 7));
  for (double y = -30; y < 70; y += 24)
    props.Building({{west - 18, y}, {6, 9}, random.Uniform(-0.05, 0.05)}, random.Uniform(7, 13),
                   true);
  for (double x = west; x < layout.length + 20; x += 26) {
    props.Building({{x, -22}, {10, 7}, random.Uniform(-0.05, 0.05)}, random.Uniform(6, 14), true);
    props.Building({{x, layout.width + 28}, {10, 7}, random.Uniform(-0.05, 0.05)},
                   random.Uniform(6, 14), true);
  }
  for (const double y : {layout.decks[0].aisle_y[0] - 4, layout.decks[0].aisle_y[1] + 4})
    props.Sign({-1, y}, M_PI);
  for (const Rectangle& foot : layout.lamp_feet) props.StreetLamp(foot.center);
}

}  // namespace

Scene BuildGarage(const SceneOptions& options) {
  const GarageLayout layout = PlanGarage(options.seed, options.day);
  const Weather weather = WeatherOf(options);
  // No sun shines in: through slits it would be a patch or two.
  const Place place = MakeGaragePlace(layout, options);
  Scene scene{.place = place,
              .sky = Sky(options.seed, weather == Weather::kDry ? Weather::kOvercast : weather),
              .bounce = Rgb(0.050f, 0.048f, 0.044f),
              .sky_reach = 60,
              .finish = std::vector<GroundFinish>(place.ground.sheets().size(), {.gloss = 0.4f})};
  scene.finish[layout.ForecourtSheet()] = {.wetness = weather == Weather::kWet ? 1.0f : 0.0f};
  for (int deck = 0; deck < layout.num_ramps(); ++deck)
    scene.finish[layout.StraightSheet(deck)] = scene.finish[layout.CurveSheet(deck)] = {};
  const Ground& ground = scene.place.ground;
  scene.ground = MakeFloors(layout, ground);
  for (int deck = 0; deck < layout.num_decks(); ++deck)
    scene.ground_colors.push_back(
        PaintDeck(layout.decks[static_cast<size_t>(deck)], GarageLayout::kStrip, options, deck));
  for (size_t sheet = layout.ForecourtSheet(); sheet < ground.sheets().size(); ++sheet) {
    const GroundSheet& floor = ground.sheets()[sheet];
    const std::uint64_t seed = SeedOfPart(options.seed, sheet);
    scene.ground_colors.push_back(sheet == layout.ForecourtSheet()
                                      ? PaintForecourt(floor, options.ground_texel, options.seed)
                                  : sheet < layout.CurveSheet(0)
                                      ? PaintStraightRamp(layout, floor, options.ground_texel, seed)
                                      : PaintCurve(layout, floor, options.ground_texel, seed));
  }
  GarageStructure structure(layout, options.seed, scene.materials);
  structure.Walls();
  structure.Ceilings(ground);
  structure.Pillars();
  structure.Rooms();
  structure.Fittings();
  Props props(ground, options.seed, weather == Weather::kDusk, LookOf(options.looks, options.seed),
              scene.materials);
  FurnishOutside(layout, props);
  for (int deck = 0; deck < layout.num_decks(); ++deck)
    for (const ParkedCar& car : layout.decks[static_cast<size_t>(deck)].cars)
      props.Car(car.footprint, deck * layout.storey, car.style, car.seed);
  scene.objects = std::move(structure.mesh());
  scene.objects.Append(props.mesh(), {});
  scene.kerbs = std::move(props.kerbs());
  std::vector<Lamp> lamps = std::move(structure.lamps());
  lamps.insert(lamps.end(), props.lamps().begin(), props.lamps().end());
  scene.lamps = LampField(std::move(lamps));
  return scene;
}

}  // namespace parkade::simulator

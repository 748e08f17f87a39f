#include "tests/simulator/scenes/garage_structure.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace parkade::simulator {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kPiece = 0.7;  // [m] of a face

}  // namespace

GarageStructure::GarageStructure(const GarageLayout& layout, std::uint64_t seed,
                                 std::vector<Material>& materials)
    : layout_(layout), random_(seed, 0x6a7a), materials_(materials) {
  concrete_ = Add({.albedo = layout.style.concrete,
                   .texture = TextureKind::kConcrete,
                   .texture_size = 5.2f,
                   .texture_contrast = 0.17f});
  paint_ = Add({.albedo = layout.style.paint,
                .mirror = 0.02f,
                .texture = TextureKind::kPlaster,
                .texture_size = 2.7f,
                .texture_contrast = 0.2f});
  ceiling_ = Add({.albedo = layout.style.ceiling,
                  .texture = TextureKind::kConcrete,
                  .texture_size = 6.1f,
                  .texture_contrast = 0.15f});
  yellow_ = Add({.albedo = Rgb(0.55f, 0.40f, 0.05f),
                 .texture = TextureKind::kPlaster,
                 .texture_contrast = 0.2f});
  black_ = Add({.albedo = Gray(0.05f), .texture = TextureKind::kPlaster, .texture_contrast = 0.3f});
  tube_ = Add({.albedo = Gray(0.8f), .emission = Rgb(3.2f, 3.1f, 2.8f)});
  dead_tube_ = Add({.albedo = Gray(0.6f)});
  metal_ = Add({.albedo = Gray(0.36f),
                .mirror = 0.05f,
                .texture = TextureKind::kPlaster,
                .texture_contrast = 0.15f});
  red_ = Add({.albedo = Rgb(0.45f, 0.05f, 0.04f),
              .texture = TextureKind::kPlaster,
              .texture_contrast = 0.1f});
  exit_ = Add({.albedo = Rgb(0.03f, 0.3f, 0.1f), .emission = Rgb(0.02f, 0.35f, 0.12f)});
  white_ = Add({.albedo = Gray(0.7f), .emission = Gray(0.25f)});
  paper_ = Add({.albedo = Gray(0.62f), .texture = TextureKind::kPlaster, .texture_contrast = 0.1f});
  pipe_ = Add(
      {.albedo = layout.style.pipe, .texture = TextureKind::kPlaster, .texture_contrast = 0.1f});
  rubber_ =
      Add({.albedo = Gray(0.12f), .texture = TextureKind::kPlaster, .texture_contrast = 0.3f});
}

MaterialId GarageStructure::Add(const Material& material) {
  materials_.push_back(material);
  return static_cast<MaterialId>(materials_.size() - 1);
}

void GarageStructure::Panel(const Vector3d& corner, const Vector3d& u, const Vector3d& v,
                            MaterialId material) {
  const int columns = 2 + static_cast<int>(u.norm() / kPiece),
            rows = 2 + static_cast<int>(v.norm() / kPiece);
  mesh_.AddSheet(
      columns, rows,
      [&](int i, int j) -> Vector3d {
        return corner + u * i / (columns - 1.0) + v * j / (rows - 1.0);
      },
      [&](int, int) { return material; });
}

void GarageStructure::Wall(const Vector2d& from, const Vector2d& to, double bottom, double top) {
  const Vector2d along = (to - from).normalized(),
                 side = GarageLayout::kWallHalf * Vector2d(-along.y(), along.x());
  const auto at = [](const Vector2d& xy, double z) { return Vector3d(xy.x(), xy.y(), z); };
  const Vector3d run = at(to - from, 0);
  const double band = std::min(top, bottom + layout_.style.paint_height);
  for (const double sign : {-1.0, 1.0}) {
    const Vector3d start = sign < 0 ? at(from - side, 0) : at(to + side, 0),
                   face = sign < 0 ? run : -run;
    Panel(start + Vector3d(0, 0, bottom), face, {0, 0, band - bottom}, paint_);
    if (top > band) Panel(start + Vector3d(0, 0, band), face, {0, 0, top - band}, concrete_);
  }
  for (const Vector2d& end : {from, to})
    Panel(at(end - side, bottom), at(2 * side, 0), {0, 0, top - bottom}, concrete_);
  Panel(at(from - side, top), run, at(2 * side, 0), concrete_);
}

void GarageStructure::WallWithGates(const Vector2d& from, const Vector2d& to, double bottom,
                                    double top, const std::vector<double>& gates) {
  const double length = (to - from).norm();
  const Vector2d along = (to - from) / length;
  double place = 0;
  for (const double gate : gates) {
    Wall(from + place * along, from + (gate - GarageLayout::kGateHalf) * along, bottom, top);
    place = gate + GarageLayout::kGateHalf;
  }
  Wall(from + place * along, to, bottom, top);
}

void GarageStructure::Parapet(const Vector2d& from, const Vector2d& to, double bottom, double top) {
  constexpr double kSill = 1.1, kLintel = 1.75;
  Wall(from, to, bottom, bottom + kSill);
  Wall(from, to, bottom + kLintel, top);
  const double length = (to - from).norm();
  const Vector2d along = (to - from) / length;
  for (double place = 1.2; place < length - 1;
       place += 1.2 + 2.4 * (static_cast<int>(place / 1.2) % 2)) {
    const Vector2d at = from + place * along;
    mesh_.AddBox({at.x(), at.y(), bottom + (kSill + kLintel) / 2},
                 {0.06, 0.08, (kLintel - kSill) / 2}, 0, concrete_);
  }
}

void GarageStructure::HalfCylinder(double radius, bool faces_inward) {
  const int columns = 2 + static_cast<int>(M_PI * radius / kPiece),
            rows = 2 + static_cast<int>(layout_.top() / kPiece);
  mesh_.AddSheet(
      columns, rows,
      [&](int i, int j) -> Vector3d {
        const double angle = M_PI * (i / (columns - 1.0) - 0.5) * (faces_inward ? -1 : 1);
        return {layout_.length + radius * std::cos(angle),
                layout_.curve_y + radius * std::sin(angle), layout_.top() * j / (rows - 1.0)};
      },
      [&](int, int) { return concrete_; });
}

void GarageStructure::Walls() {
  const double length = layout_.length, width = layout_.width, north = width + GarageLayout::kStrip;
  const auto& aisle = layout_.decks[0].aisle_y;
  for (int deck = 0; deck < layout_.num_decks(); ++deck) {
    const double bottom = deck * layout_.storey,
                 top = bottom + layout_.storey - GarageLayout::kSlab;
    Parapet({0, 0}, {length, 0}, bottom, top);
    std::vector<double> west, east;
    if (deck == 0) west = {aisle[0], aisle[1]};
    if (deck + 1 < layout_.num_decks()) east.push_back(aisle[0]);
    if (deck > 0) east.push_back(aisle[1]);
    WallWithGates({0, 0}, {0, north}, bottom, top, west);
    WallWithGates({length, 0}, {length, north}, bottom, top, east);
  }
  Wall({length, north}, {0, north}, 0, layout_.top());
  Wall({GarageLayout::kStripWallEnd, width}, {length - GarageLayout::kStripWallEnd, width}, 0,
       layout_.top());
  Wall({layout_.ramp_to, width}, {layout_.ramp_to, north}, 0, layout_.storey - GarageLayout::kSlab);
  Wall({layout_.ramp_from, width}, {layout_.ramp_from, north}, layout_.top() - layout_.storey,
       layout_.top());
  HalfCylinder(layout_.curve_radius - GarageLayout::kCurveHalfWidth, false);
  HalfCylinder(layout_.curve_radius + GarageLayout::kCurveHalfWidth, true);
  HalfCylinder(layout_.curve_radius + GarageLayout::kCurveHalfWidth + 0.2, false);
  // The edges of the roof, seen from the forecourt.
  Wall({-0.2, -0.2}, {-0.2, north + 0.2}, layout_.top() - GarageLayout::kSlab, layout_.top() + 0.9);
}

void GarageStructure::Ceilings(const Ground& ground) {
  const double slab = GarageLayout::kSlab, length = layout_.length, width = layout_.width;
  const auto under = [&](double x0, double x1, double y0, double y1, double z) {
    Panel({x0, y1, z}, {x1 - x0, 0, 0}, {0, y0 - y1, 0}, ceiling_);
  };
  for (int deck = 1; deck <= layout_.num_decks(); ++deck) {
    const double z = deck * layout_.storey - slab;
    under(0, length, 0, width, z);
    under(0, layout_.ramp_from, width, width + GarageLayout::kStrip, z);
    under(layout_.ramp_to, length, width, width + GarageLayout::kStrip, z);
  }
  const double roof = layout_.top() - slab;
  under(layout_.ramp_from, layout_.ramp_to, width, width + GarageLayout::kStrip, roof);
  const double reach = layout_.curve_radius + 2.8;
  under(length, length + reach, layout_.curve_y - reach, layout_.curve_y + reach, roof);
  // The undersides of the ramps.
  const int columns = 40, rows = 9;
  for (int deck = 0; deck < layout_.num_ramps(); ++deck) {
    const auto& straight = ground.sheets()[layout_.StraightSheet(deck)];
    mesh_.AddSheet(
        columns, rows,
        [&](int i, int j) -> Vector3d {
          const Vector2d xy(straight.min.x() + layout_.straight.run * i / (columns - 1.0),
                            straight.max.y() - GarageLayout::kStrip * j / (rows - 1.0));
          return {xy.x(), xy.y(), straight.height(xy) - slab};
        },
        [&](int, int) { return ceiling_; });
    const auto& curve = ground.sheets()[layout_.CurveSheet(deck)];
    mesh_.AddSheet(
        columns, rows,
        [&](int i, int j) -> Vector3d {
          const double angle = M_PI * (i / (columns - 1.0) - 0.5),
                       radius = layout_.curve_radius +
                                GarageLayout::kCurveHalfWidth * (2 * j / (rows - 1.0) - 1);
          const Vector2d xy = Vector2d(length, layout_.curve_y) +
                              radius * Vector2d(std::cos(angle), std::sin(angle));
          return {xy.x(), xy.y(), curve.height(xy) - slab};
        },
        [&](int, int) { return ceiling_; });
  }
}

void GarageStructure::Pillars() {
  constexpr double kBand = 0.22;
  const double clear = layout_.storey - GarageLayout::kSlab;
  for (int deck = 0; deck < layout_.num_decks(); ++deck) {
    const double z = deck * layout_.storey;
    std::set<long> beams;
    for (const Rectangle& pillar : layout_.pillars) {
      const Vector3d foot(pillar.center.x(), pillar.center.y(), z);
      for (double height = 0; height < clear - 0.01; height += kBand) {
        const double half = std::min(kBand, clear - height) / 2;
        mesh_.AddBox(foot + Vector3d(0, 0, height + half),
                     {pillar.half_size.x(), pillar.half_size.y(), half}, pillar.yaw,
                     PillarMaterial(height + half));
      }
      if (layout_.style.has_bays_named)
        BayBoard(pillar, z, static_cast<int>(&pillar - layout_.pillars.data()));
      beams.insert(std::lround(pillar.center.x() * 100));
    }
    for (const long beam : beams)
      for (double y = 0; y < layout_.width; y += 1.5)
        mesh_.AddBox({static_cast<double>(beam) / 100, y + 0.75, z + clear - 0.14},
                     {0.14, 0.75, 0.14}, 0, ceiling_);
  }
}

MaterialId GarageStructure::PillarMaterial(double height) const {
  const int band = static_cast<int>(height / 0.22);
  switch (layout_.style.pillars) {
    case PillarPaint::kBands: return band >= 5 ? concrete_ : band % 2 ? black_ : yellow_;
    case PillarPaint::kFoot: return height < 1 ? paint_ : paper_;
    case PillarPaint::kRing: return band == 1 || band == 6 ? red_ : concrete_;
    case PillarPaint::kFull: return band == 7 ? paper_ : paint_;
  }
  return concrete_;
}

void GarageStructure::TubeLamp(const Vector3d& at, double yaw) {
  const bool is_on = !random_.Chance(0.1);
  const float strength =
                  static_cast<float>(layout_.style.lamp_strength * random_.Uniform(1.6, 2.6)),
              warm = static_cast<float>(1 - 0.14 * layout_.style.lamp_warmth -
                                        random_.Uniform(0, 0.05));
  mesh_.AddBox(at + Vector3d(0, 0, 0.06), {0.8, 0.11, 0.03}, yaw, metal_);
  mesh_.AddBox(at, {0.75, 0.05, 0.03}, yaw, is_on ? tube_ : dead_tube_);
  if (!is_on) return;
  const Vector3d along(std::cos(yaw), std::sin(yaw), 0);
  for (const double side : {-0.45, 0.45})
    lamps_.push_back({(at + side * along - Vector3d(0, 0, 0.06)).cast<float>(),
                      Rgb(1, 0.5f + 0.5f * warm, warm * 0.95f) * (strength / 2)});
}

void GarageStructure::Pipe(const Vector3d& from, const Vector3d& to, double radius,
                           MaterialId material) {
  const double length = (to - from).norm();
  const int pieces = 1 + static_cast<int>(length / 2);
  for (int i = 0; i < pieces; ++i) {
    const Vector3d a = from + (to - from) * i / pieces, b = from + (to - from) * (i + 1) / pieces;
    mesh_.AddCylinder(a, b, radius, radius, material, 8);
    mesh_.AddCylinder(b - (to - from) * (0.06 / length), b, radius * 1.25, radius * 1.25, material,
                      8);
  }
}

void GarageStructure::ExitSign(const Vector3d& at, double yaw) {
  mesh_.AddBox(at, {0.03, 0.32, 0.12}, yaw, exit_);
  const Vector3d left(-std::sin(yaw), std::cos(yaw), 0);
  for (const double side : {-1.0, 1.0}) {
    mesh_.AddBox(at + 0.12 * side * left, {0.034, 0.07, 0.018}, yaw, white_);
    mesh_.AddBox(at + 0.12 * side * left + Vector3d(0, 0, 0.05), {0.034, 0.025, 0.03}, yaw, white_);
  }
}

void GarageStructure::Poster(const Vector3d& at, double yaw) {
  const Vector3d left(-std::sin(yaw), std::cos(yaw), 0);
  const double half_width = random_.Uniform(0.25, 0.7), half_height = random_.Uniform(0.3, 0.5);
  const MaterialId inks[] = {paper_, red_, black_, yellow_, paint_};
  mesh_.AddBox(at, {0.02, half_width, half_height}, yaw, inks[random_.Index(3)]);
  for (int i = 0; i < 9; ++i)
    mesh_.AddBox(at + left * random_.Uniform(-0.8, 0.8) * half_width +
                     Vector3d(0, 0, random_.Uniform(-0.8, 0.8) * half_height),
                 {0.024 + 0.0005 * i, random_.Uniform(0.02, 0.3) * half_width,
                  random_.Uniform(0.03, 0.15) * half_height},
                 yaw, inks[random_.Index(5)]);
}

void GarageStructure::DeckFittings(int deck) {
  const double floor = deck * layout_.storey,
               ceiling = floor + layout_.storey - GarageLayout::kSlab;
  const double length = layout_.length, width = layout_.width;
  for (const double y : layout_.decks[0].aisle_y) {
    const GarageStyle& style = layout_.style;
    for (double x = 3.5; x < length; x += style.lamp_step)
      TubeLamp({x, y + style.lamp_aside, ceiling - 0.16}, style.lamps_lie_across ? M_PI / 2 : 0);
    const double thin = y + style.pipe_aside, thick = y - style.pipe_aside - 0.5;
    Pipe({0.3, thin, ceiling - 0.42}, {length - 0.3, thin, ceiling - 0.42}, 0.05, pipe_);
    Pipe({0.3, thick, ceiling - 0.46}, {length - 0.3, thick, ceiling - 0.46}, 0.14, metal_);
    for (const double x : {1.2, length - 1.2})
      ExitSign({x, y + 1.2, ceiling - 0.3}, x < 5 ? 0 : M_PI);
    ExitSign({length / 2, y, ceiling - 0.35}, 0);
  }
  for (const double x : {4.0, length - 4.0})
    for (const double y : {width / 2, width - 2.5, width + 2.5})
      TubeLamp({x, y, ceiling - 0.16}, M_PI / 2);
  for (double x = 11; x < length - 10; x += layout_.style.poster_step * random_.Uniform(0.6, 1.4)) {
    Poster({x, width - 0.14, floor + random_.Uniform(1.2, 1.9)}, -M_PI / 2);
    if (random_.Chance(0.6)) Poster({x + 1.7, 0.14, floor + 0.6}, M_PI / 2);
  }
  for (double y = 2; y < width; y += random_.Uniform(3, 6)) {
    const bool is_gate = std::abs(y - layout_.decks[0].aisle_y[0]) < 4 ||
                         std::abs(y - layout_.decks[0].aisle_y[1]) < 4;
    if (is_gate) continue;
    Poster({0.14, y, floor + random_.Uniform(1.2, 1.8)}, 0);
    Poster({length - 0.14, y, floor + random_.Uniform(1.2, 1.8)}, M_PI);
  }
}

void GarageStructure::Fittings() {
  for (int deck = 0; deck < layout_.num_decks(); ++deck) DeckFittings(deck);
  for (int deck = 0; deck < layout_.num_ramps(); ++deck) {
    RampLamps(deck);
    for (const bool is_far : {false, true}) {
      CurveWall(deck, is_far);
      RampWall(deck, is_far);
    }
  }
}

}  // namespace parkade::simulator

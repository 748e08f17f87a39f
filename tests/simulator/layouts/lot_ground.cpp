#include "tests/simulator/layouts/lot_ground.h"

#include <cmath>

#include "tests/simulator/ground/ground_painter.h"
#include "tests/simulator/ground/season.h"
#include "tests/simulator/layouts/slot_marks.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;

Vector2d InAnySlot(const LotLayout& layout, Random& random) {
  const Rectangle& slot =
      layout.slots[static_cast<size_t>(random.Index(static_cast<int>(layout.slots.size())))];
  return slot.center + Vector2d(random.Uniform(-0.6, 0.6), random.Uniform(-1.5, 1.5));
}

/// Slot lines or their marks, arrows and stop lines.
void Mark(const LotLayout& layout, SlotMarks marks, GroundPainter& painter) {
  for (const Rectangle& slot : layout.slots) {
    const Vector2d into(std::cos(slot.yaw), std::sin(slot.yaw)), across(-into.y(), into.x());
    if (marks != SlotMarks::kUsual) {
      MarkSlot(slot, into, marks, painter);
      continue;
    }
    const float wear = static_cast<float>(painter.random().Uniform(0.15, 0.5));
    for (const double side : {-1.0, 1.0}) {
      const Vector2d middle = slot.center + side * slot.half_size.y() * across;
      painter.Line(middle - slot.half_size.x() * into, middle + slot.half_size.x() * into, 0.11,
                   wear);
    }
  }
  for (int aisle = 0; aisle < 2; ++aisle) {
    const double direction = layout.long_loop[0].y() == layout.aisle_y[aisle] ? 1 : -1;
    for (double x = 14; x < layout.length - 12; x += painter.random().Uniform(13, 19))
      painter.Arrow({x, layout.aisle_y[aisle] + painter.random().Uniform(-0.2, 0.2)},
                    direction > 0 ? 0 : M_PI);
  }
  for (const double x : {7.6, layout.length - 7.6})
    for (const double y : layout.aisle_y)
      for (double offset = -2.6; offset < 2.7; offset += 0.95)
        painter.Line({x, y + offset}, {x, y + offset + 0.5}, 0.3, 0.35f);
}

/// Stripes that warn of speed bumps.
void MarkBumps(const LotLayout& layout, GroundPainter& painter) {
  for (const Vector2d& bump : layout.bumps)
    for (double y = -2.8; y < 2.9; y += 0.7)
      painter.Line(bump + Vector2d(-1.7, y), bump + Vector2d(1.7, y), 0.32, 0.3f, kYellowPaint);
}

/// Gutters along the aisles' edges, one across, and grates before the outer kerbs.
void AddDrains(const LotLayout& layout, GroundPainter& painter) {
  Random& random = painter.random();
  for (const double y : layout.aisle_y) {
    const double edge = y + (random.Chance(0.5) ? 2.7 : -2.7);
    painter.Gutter({4, edge}, {layout.length - 4, edge});
  }
  const double across = random.Uniform(0.3, 0.7) * layout.length;
  painter.Gutter({across, 1}, {across, layout.width - 1});
  for (double x = random.Uniform(3, 9); x < layout.length - 1; x += random.Uniform(8, 14))
    for (const double y : {0.2, layout.width - 0.2}) painter.Drain({x, y}, 0);
}

/// Slots with numbers, and where everybody drives.
void MarkDeck(const LotLayout& layout, GroundPainter& painter, int first_number) {
  for (const double y : layout.aisle_y)
    for (const double side : {-0.75, 0.75})
      painter.TireTrack({3, y + side}, {layout.length - 3, y + side}, 0.6, 0.35f);
  for (const double x : {4.0, layout.length - 4})
    for (const double side : {-0.75, 0.75})
      painter.TireTrack({x + side, 4}, {x + side, layout.width + 3}, 0.6, 0.3f);
  for (const Rectangle& slot : layout.slots) {
    const Vector2d into(std::cos(slot.yaw), std::sin(slot.yaw));
    painter.Number(first_number++, slot.center - (slot.half_size.x() - 0.55) * into,
                   slot.yaw - M_PI / 2, 0.5);
  }
}

/// The way to the ramps, beside the slots: worn and dirty.
void MarkStrip(const LotLayout& layout, double strip, GroundPainter& painter) {
  constexpr double kPerMeter = 3;
  const double middle = layout.width + strip / 2;
  const auto anywhere = [&] {
    return Vector2d(painter.random().Uniform(0, layout.length),
                    layout.width + painter.random().Uniform(0.2, strip - 0.2));
  };
  for (const double side : {-0.75, 0.75})
    painter.TireTrack({3, middle + side}, {layout.length - 3, middle + side}, 0.6, 0.4f);
  for (const double y : {layout.width + 0.35, layout.width + strip - 0.35})
    painter.Line({9.5, y}, {layout.length - 9.5, y}, 0.12, 0.3f, kYellowPaint);
  painter.Cracks(static_cast<int>(layout.length / 5), anywhere);
  painter.Stains(static_cast<int>(kPerMeter * layout.length), anywhere, anywhere);
  painter.Litter(static_cast<int>(kPerMeter * layout.length), anywhere);
}

}  // namespace

GroundCanvas PaintLot(const LotLayout& layout, const RoadLook& road, const SceneOptions& options) {
  GroundCanvas canvas(Vector2d::Zero(), Vector2d(layout.length, layout.width),
                      options.ground_texel);
  const double area = layout.length * layout.width;
  const auto per_area = [&](double square_meters) {
    return static_cast<int>(area / square_meters);
  };
  GroundPainter painter({layout.length, layout.width}, canvas, options.seed);
  painter.Asphalt(road);
  painter.Patches(per_area(90));
  painter.Cracks(per_area(45));
  painter.Stains(per_area(14), [&] { return InAnySlot(layout, painter.random()); });
  Mark(layout, SlotMarksOf(options.slot_marks), painter);
  MarkBumps(layout, painter);
  for (int i = 0; i < per_area(350); ++i) {
    const double x = painter.random().Uniform(2, layout.length - 2);
    painter.Manhole(
        {x, layout.aisle_y[painter.random().Index(2)] + painter.random().Uniform(-2, 2)});
  }
  painter.Litter(per_area(0.5));
  if (options.has_drains) AddDrains(layout, painter);
  LaySeason(
      SeasonOf(options.season), [&](const Vector2d& at) { return layout.FromKerb(at); }, painter);
  canvas.Finish();
  return canvas;
}

GroundCanvas PaintDeck(const LotLayout& layout, double strip, const SceneOptions& options,
                       int deck) {
  GroundCanvas canvas(Vector2d::Zero(), Vector2d(layout.length, layout.width + strip),
                      options.ground_texel);
  const double area = layout.length * layout.width;
  const auto per_area = [&](double square_meters) {
    return static_cast<int>(area / square_meters);
  };
  GroundPainter painter({layout.length, layout.width + strip}, canvas,
                        SeedOfPart(options.seed, static_cast<std::uint64_t>(deck)));
  painter.Concrete();
  painter.Cracks(per_area(120));
  painter.Stains(per_area(6), [&] { return InAnySlot(layout, painter.random()); });
  const auto anywhere = [&] { return painter.Anywhere(); };
  painter.Stains(per_area(12), anywhere);
  Mark(layout, SlotMarks::kUsual, painter);
  MarkDeck(layout, painter, 100 * (deck + 1) + 1);
  MarkStrip(layout, strip, painter);
  painter.Litter(per_area(1.5));
  if (options.has_drains) AddDrains(layout, painter);
  canvas.Finish();
  return canvas;
}

Mesh MakeLotGround(const LotLayout& layout, const Ground& ground) {
  const int columns = static_cast<int>(std::lround(layout.length * 4)) + 1,
            rows = static_cast<int>(std::lround(layout.width * 4)) + 1;
  Mesh mesh;
  mesh.AddSheet(
      columns, rows,
      [&](int i, int j) -> Eigen::Vector3d {
        const double x = layout.length * i / (columns - 1), y = layout.width * j / (rows - 1);
        return {x, y, ground.Height({x, y}, 0)};
      },
      [](int, int) { return MaterialId{0}; });
  return mesh;
}

}  // namespace parkade::simulator

#include "mapping/kerbs/kerb_looks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "mapping/ground/cell_finder.h"

namespace parkade {
namespace {

constexpr double kStep = 0.1;                 // [m] between places that are asked
constexpr double kFirstRow = -0.25;           // [m] beyond the outline
constexpr int kRowsOfKerb = 8;                // among which a kerb lies
constexpr int kRowsBefore = 4, kRows = 13;    // what lies behind it begins after the first
constexpr double kSameDeck = 1.0;             // [m]
constexpr double kClear = 0.5, kFaint = 0.2;  // beliefs
constexpr double kSeenShare = 0.5;            // of what lies behind

/// Mean beliefs of a row of cells along a strip.
struct RowLook {
  double kerb = 0;
  double raised = 0;  ///< kerb, pavement or vegetation
};

/// Nothing where no cell tells a class.
std::optional<RowLook> LookAtRow(const OutlineStrip& strip, double length, double outward,
                                 const CellFinder& cells) {
  const auto belief = [](const SurfaceCell& cell, SurfaceClass surface) {
    return cell.class_beliefs[static_cast<std::size_t>(surface)] / 255.0;
  };
  RowLook look;
  int count = 0;
  const int num_places = std::max(1, static_cast<int>(std::lround(length / kStep)));
  for (int i = 0; i < num_places; ++i) {
    const double s = length * ((i + 0.5) / num_places - 0.5);
    const Eigen::Vector2d place =
        strip.foot.head<2>() + s * strip.along + outward * strip.Outward();
    const SurfaceCell* cell = cells.Find({place.x(), place.y(), strip.foot.z()});
    if (cell == nullptr ||
        std::abs(static_cast<double>(cell->height) - strip.foot.z()) > kSameDeck ||
        std::ranges::all_of(cell->class_beliefs, [](std::uint8_t value) { return value == 0; }))
      continue;
    const double kerb = belief(*cell, SurfaceClass::kKerb);
    look.kerb += kerb;
    look.raised +=
        kerb + belief(*cell, SurfaceClass::kPavement) + belief(*cell, SurfaceClass::kVegetation);
    ++count;
  }
  if (count == 0) return {};
  return RowLook{look.kerb / count, look.raised / count};
}

KerbLook LookAtStrip(const OutlineStrip& strip, double length, const CellFinder& cells) {
  double kerb = 0, raised = 0;
  int num_behind = 0;
  for (int i = 0; i < kRows; ++i) {
    const std::optional<RowLook> row = LookAtRow(strip, length, kFirstRow + i * kStep, cells);
    if (!row) continue;
    if (i < kRowsOfKerb) kerb = std::max(kerb, row->kerb);
    if (i < kRowsBefore) continue;
    raised += row->raised;
    ++num_behind;
  }
  if (num_behind < kSeenShare * (kRows - kRowsBefore)) return KerbLook::kUnknown;
  raised /= num_behind;
  if (kerb >= kClear && raised >= kClear) return KerbLook::kKerb;
  return kerb < kFaint && raised < kFaint ? KerbLook::kNone : KerbLook::kUnknown;
}

}  // namespace

std::vector<KerbLook> LookBeyond(std::span<const OutlineStrip> strips, double length,
                                 const SurfaceMap& surface) {
  const CellFinder cells(surface);
  return ParallelMap(strips.size(),
                     [&](std::size_t i) { return LookAtStrip(strips[i], length, cells); });
}

}  // namespace parkade

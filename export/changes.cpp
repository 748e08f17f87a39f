#include "export/changes.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <tuple>

#include "export/free_space.h"
#include "export/geojson.h"

namespace parkade {
namespace {

constexpr std::array<std::uint8_t, 3> kUnchangedColor{176, 180, 186};

std::array<std::uint8_t, 3> ColorOf(GroundChange change) {
  switch (change) {
    case GroundChange::kFreed: return {22, 148, 70};
    case GroundChange::kBlocked: return {206, 38, 38};
    case GroundChange::kMapped: return {186, 226, 190};
    case GroundChange::kUnmapped: return {240, 196, 190};
    case GroundChange::kRaised: return {118, 68, 186};
    case GroundChange::kLowered: return {240, 146, 32};
  }
  return kUnchangedColor;
}

/// The region as polygons, none of which lies above itself.
std::string FormatMultiPolygon(const ChangedRegion& region, double cell_size,
                               const std::optional<SiteDatum>& datum) {
  SurfaceMap surface{cell_size, {region.cells.begin(), region.cells.end()}};
  for (SurfaceCell& cell : surface.cells) cell.free_belief = 1;
  FreeSpaceOptions options;
  options.min_area = 0;
  options.max_step = 0.35;  // regions were grouped with steps of 0.3 m
  std::string text;
  for (const FreeSheet& sheet : FindFreeSheets(surface, options))
    text += (text.empty() ? "" : ",") + FormatPolygon(sheet.rings, datum);
  return R"({"type":"MultiPolygon","coordinates":[)" + text + "]}";
}

}  // namespace

std::string EncodeChangesGeoJson(const SurfaceChanges& changes,
                                 const std::optional<SiteDatum>& datum) {
  std::vector<std::string> features;
  for (size_t i = 0; i < changes.regions.size(); ++i) {
    const ChangedRegion& region = changes.regions[i];
    char properties[192];
    std::snprintf(properties, sizeof properties,
                  R"({"id":%zu,"change":"%s","area_m2":%.3f,"height_change_m":%.3f})", i,
                  ToText(region.change), region.area, region.height_change);
    features.push_back(R"({"type":"Feature","properties":)" + std::string(properties) +
                       R"(,"geometry":)" + FormatMultiPolygon(region, changes.cell_size, datum) +
                       "}");
  }
  return FormatFeatureCollection(features, datum);
}

Orthophoto RenderChanges(const SurfaceChanges& changes) {
  SurfaceMap painted{changes.cell_size, {}};
  const auto add = [&](const std::vector<SurfaceCell>& cells,
                       const std::array<std::uint8_t, 3>& color) {
    for (SurfaceCell cell : cells) {
      cell.color = color;
      painted.cells.push_back(cell);
    }
  };
  add(changes.unchanged, kUnchangedColor);
  for (const ChangedRegion& region : changes.regions) add(region.cells, ColorOf(region.change));
  return RenderOrthophoto(painted);
}

}  // namespace parkade

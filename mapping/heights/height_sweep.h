#pragma once

#include <functional>
#include <span>
#include <vector>

#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/ground_squares.h"
#include "mapping/heights/height_field.h"
#include "mapping/heights/measure_heights_options.h"
#include "mapping/heights/sweep_tile.h"

namespace parkade {

/// One window of ground at all heights of a sweep.
struct SweptWindow {
  int deck = 0, x = 0,
      y = 0;                          ///< its lower corner lies at (x, y) times the window's side
  double deck_height = 0;             ///< [m] of the nearest car: tells decks apart
  double parallax = 0;                ///< [m per meter of height] see TileSweep::Parallaxes
  std::vector<Agreement> agreements;  ///< one per height of the sweep
  std::vector<Agreement> coarse;      ///< the same of larger cells, for whoever judges
  std::vector<float> costs;           ///< of whoever judges the agreements; else empty
};

/// Lifts and lowers the field to each of `offsets` [m] from it. Windows that nothing was seen of
/// are left out. Windows are in order of deck, y and x, whatever the number of threads. Memory: 24
/// bytes per sample of 500 patches (some 100 m of a drive), or of as many as reach into a square of
/// 14 m. \param only  the squares to sweep, made by SweepSquares; null: all
std::vector<SweptWindow> SweepWindows(const PatchSource& patches, std::span<const DrivenPath> paths,
                                      const HeightField& field, std::span<const float> offsets,
                                      const MeasureHeightsOptions& options,
                                      const std::function<void(SweptWindow&)>& judge = {},
                                      const GroundSquares* only = nullptr);

/// None of the squares that SweepWindows sweeps one by one, whose windows need no others.
GroundSquares SweepSquares(double window);

}  // namespace parkade

#pragma once

#include <span>
#include <vector>

#include "mapping/driven_path.h"
#include "mapping/height_field.h"
#include "mapping/measure_heights.h"
#include "mapping/patch_source.h"

namespace parkade {

/// How well views agree over a piece of ground at one height.
struct Agreement {
  float residual = 0, total = 0;  ///< of squared grey values: within cells, and altogether
  float weight = 0;
  int num_samples = 0, num_cells = 0;

  void Add(const Agreement& other) {
    residual += other.residual;
    total += other.total;
    weight += other.weight;
    num_samples += other.num_samples;
    num_cells += other.num_cells;
  }

  /// Share of the variance that remains within cells: 1 where heights do not matter.
  double Misfit() const {
    const double freedom = num_samples - num_cells;
    return freedom > 0 && total > 0 ? static_cast<double>(residual) / static_cast<double>(total) * num_samples / freedom
                                    : 1;
  }
};

/// One window of ground at all heights of a sweep.
struct SweptWindow {
  int deck = 0, x = 0, y = 0;         ///< its lower corner lies at (x, y) times the window's side
  double deck_height = 0;             ///< [m] of the nearest car: tells decks apart
  std::vector<Agreement> agreements;  ///< 2 num_steps + 1, from -max_offset to max_offset
};

/// Lifts and lowers the field by up to `max_offset` [m]. Windows that nothing was seen of are left out. Windows are in
/// order of deck, y and x, whatever the number of threads. Memory: 32 bytes per sample in a square of 43 m
/// or, where more than 300 patches reach into it, of 14.
std::vector<SweptWindow> SweepWindows(const PatchSource& patches, std::span<const DrivenPath> paths,
                                      const HeightField& field, double max_offset,
                                      const MeasureHeightsOptions& options);

}  // namespace parkade

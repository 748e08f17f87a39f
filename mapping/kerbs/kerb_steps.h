#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/kerbs/kerb_looks.h"
#include "mapping/kerbs/outline_strips.h"

namespace parkade {

/// A step up at the outline, as one strip and those beside it tell it.
struct KerbStep {
  static constexpr double kMaxHeight = 0.34;    ///< [m] more is not looked for
  static constexpr double kMaxKerb = 0.25;      ///< [m] more is the sill of a car or a wall
  static constexpr double kLeastSigma = 0.005;  ///< [m]
  static constexpr double kStripLength = 0.5;   ///< [m]
  static constexpr double kUsual = 0.12, kUsualSigma = 0.04;  ///< [m] all that is known before
  static constexpr int kReach = 2;  ///< strips to each side that are asked together with one

  double height = 0, sigma = 0;  ///< [m]
};

/// Whether two steps may be of one kerb.
bool Agree(const KerbStep& a, const KerbStep& b);

/// Strips by ring and place along it.
using StripsAlong = std::map<std::pair<int, int>, std::size_t>;

/// The strips up to `reach` to each side of one, and itself.
std::vector<std::size_t> Around(const OutlineStrip& strip, const StripsAlong& along, int reach);

/// The steps of all strips that tell one, however high they are: what lies just beyond the outline
/// is swept, next to it and farther off, and so is the ground before it. Strips along an outline
/// have a say in each other's heights (SumAlongChains): kerbs go on, chance does not. What looks
/// like a kerb is one unless views say that it is lower than `min_height` [m]; where they say
/// little, its height is that of the strips along it, with the sigma of what is known. One entry
/// per strip. In parallel, the same every time.
std::vector<std::optional<KerbStep>> MeasureSteps(std::span<const OutlineStrip> strips,
                                                  std::span<const KerbLook> looks,
                                                  const StripsAlong& along, double min_height,
                                                  const PatchSource& patches,
                                                  std::span<const DrivenPath> paths);

}  // namespace parkade

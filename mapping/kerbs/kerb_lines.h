#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapping/kerbs/kerb_looks.h"
#include "mapping/kerbs/kerb_steps.h"
#include "mapping/kerbs/outline_strips.h"

namespace parkade {

/// Kerbs go straight on: a strip of the outline that lies on the line of kerbs within 15 m, along
/// it, is one of them where nothing speaks against that. Between parked cars ground is seen for a
/// moment, and from one side. Such strips get the height of those kerbs, and their spread as sigma.
/// A strip stays what it is where it looks like something else, or was seen to be lower than
/// `min_height` [m], or higher than kerbs are. O(strips near each other).
/// \param steps, is_kerb  one per strip; both are added to
void ContinueLines(std::span<const OutlineStrip> strips, std::span<const KerbLook> looks,
                   const StripsAlong& along, double min_height,
                   std::vector<std::optional<KerbStep>>& steps, std::vector<bool>& is_kerb);

}  // namespace parkade

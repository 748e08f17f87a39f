#pragma once

#include <span>

#include "mapping/ground/driven_path.h"
#include "mapping/heights/height_field.h"

namespace parkade {

/// How the planes of a drive's poses lie to the ground.
struct SuspensionFit {
  /// The lean under which the planes agree best with heights that were measured otherwise, up to 8
  /// m from the car. None where hardly anything is known, or where the car neither braked nor
  /// turned.
  SuspensionModel lean;
  /// How far the planes err once they lean so, as a multiple of the sigmas that the samples of
  /// patches declare: a deck is flatter than a street. In [0.1, 1]; 1 where hardly anything is
  /// known.
  double plane_errors = 1;
};

/// \param path  its own lean and plane errors are not asked for
/// \param heights  those that count as measured have a sigma of 3 cm or less
SuspensionFit EstimateSuspension(const DrivenPath& path,
                                 std::span<const HeightObservation> heights);

}  // namespace parkade

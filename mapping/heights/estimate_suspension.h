#pragma once

#include <span>

#include "mapping/ground/driven_path.h"
#include "mapping/heights/height_field.h"

namespace parkade {

/// How the body leans with acceleration on a drive's springs: the lean under which the planes of
/// its poses agree best with heights that were measured otherwise, up to 8 m from the car. None
/// where hardly anything is known, or where the car neither braked nor turned. \param heights those
/// that count as measured have a sigma of 3 cm or less
SuspensionModel EstimateSuspension(const DrivenPath& path,
                                   std::span<const HeightObservation> heights);

/// How far the planes of a path's poses err, as a multiple of the sigmas that the samples of
/// patches declare: a deck is flatter than a street. In [0.1, 1]; 1 where hardly anything is known.
double EstimatePlaneErrors(const DrivenPath& path, std::span<const HeightObservation> heights);

}  // namespace parkade

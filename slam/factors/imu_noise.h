#pragma once

#include <span>

#include "core/drive_log.h"
#include "core/rig.h"

namespace parkade {

/// `declared` with noise densities raised to what `samples`, in order of time, show: motors and
/// roads shake an IMU far more than a datasheet says. White noise is as strong at all frequencies,
/// so that of three bands at the upper end of the spectrum the quietest counts, which motion does
/// not reach; half as much again as declared is chance.
///
/// D. A. Howe et al., "A Total Estimator of the Hadamard Function Used for GPS Operations", PTTI
/// 2000, equation (1), of samples and of means of two and of four.
ImuCalibration WithMeasuredNoise(const ImuCalibration& declared,
                                 std::span<const ImuSample> samples);

}  // namespace parkade

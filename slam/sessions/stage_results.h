#pragma once

#include <string>
#include <string_view>

#include "slam/loops/close_loops.h"
#include "slam/refinement/drive_residuals.h"
#include "slam/refinement/refine_drive.h"
#include "slam/refinement/sensor_agreement.h"
#include "slam/sessions/session_loops.h"

namespace parkade {

// Results of stages as bytes, so that a later build with the same inputs need not find them again.
// Little-endian, without a version: whoever keeps them knows what they are. Exact: what is read
// equals what was written, except that the seconds of computing are 0. Reading throws
// Error{kInvalidInput} for other bytes.

/// Raised whenever one of the layouts, those of keyframe_bytes.h and place_words.h among them, or
/// what a stage does with the same inputs, changes.
constexpr int kStageResultsVersion = 9;

std::string EncodeAgreement(SensorAgreement agreement);
SensorAgreement DecodeAgreement(std::string_view bytes);

/// Loops of maps that older versions made come back without views.
std::string EncodeLoops(LoopClosure loops);
LoopClosure DecodeLoops(std::string_view bytes);

/// \param rig  of the odometry, whose lenses and masks stay
std::string EncodeRefinement(DriveRefinement refinement);
DriveRefinement DecodeRefinement(std::string_view bytes, const Rig& rig);

std::string EncodeResiduals(DriveResiduals residuals);
DriveResiduals DecodeResiduals(std::string_view bytes);

std::string EncodeLinks(SessionLoops links);
SessionLoops DecodeLinks(std::string_view bytes);

}  // namespace parkade

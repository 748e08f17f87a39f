#pragma once

#include "core/camera_model.h"
#include "server/ingest/messages/message_decoding.h"

namespace parkade {

/// The lens that a CameraInfo describes: plumb_bob; rational_polynomial where its denominator is 1;
/// equidistant, also spelled fisheye or kannala_brandt; none. `is_rectified`: the lens of the
/// rectified image (P, no distortion). Throws Error{kInvalidInput} with a sentence that begins with
/// `camera`, even for a camera that is not calibrated.
CameraModel ModelFromCameraInfo(const CameraInfoMessage& info, bool is_rectified,
                                const std::string& camera);

}  // namespace parkade

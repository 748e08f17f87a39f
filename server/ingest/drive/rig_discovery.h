#pragma once

#include "core/rig.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// The rig of a log that came without one: lenses from CameraInfo, mountings from /tf_static.
///
/// A camera is each folder of topics that holds images; where it holds several image topics (raw,
/// rectified, compressed), one is taken, raw before rectified. Its CameraInfo is
/// `<folder>/camera_info`; its frame is that of its images. Cameras are called cam0, cam1, ... in
/// the order of their topics. Body is the frame rear_axle, base_footprint or base_link, the first
/// of these that is connected with the IMU's; without any, body is the IMU frame and wheels cannot
/// be used. IMU noise: the defaults of ImuCalibration. Reads the log until all is found. Throws
/// Error{kInvalidInput} naming everything that is missing in one sentence.
Rig DiscoverRig(const MessageSource& source);

}  // namespace parkade

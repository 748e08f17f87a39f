#pragma once

#include <cstdint>
#include <filesystem>

#include "core/drive_log.h"

namespace parkade {

/// What the least that a map could do would cost on this machine, now: the unit that its stages are
/// measured in, as machines and hours differ. Processor seconds of one thread.
struct SpeedFloor {
  std::int64_t images = 0;  ///< of the whole drive, all cameras
  double follow = 0;   ///< [s] per image: to decode it and to follow its corners there and back
  double network = 0;  ///< [s] per image: to ask the network of free space
  double copy = 0;     ///< [s] to copy the map's files once in memory
};

/// \param sample  images that are followed: pieces of all of the drive, shared by the cameras
///
/// "To follow" is OpenCV's pyramid and Lucas-Kanade, of 180 corners in windows of 17 pixels, whose
/// detection is not counted; images are packed as JPEGs of quality 90 before.
SpeedFloor MeasureSpeedFloor(const DriveLog& log, const std::filesystem::path& map, int sample);

}  // namespace parkade

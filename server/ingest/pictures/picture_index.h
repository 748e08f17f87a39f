#pragma once

#include <string>
#include <vector>

#include "core/rig.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// One image of a log, on the IMU's clock as the log's own rig has it.
struct IndexedImage {
  Timestamp time;
  MessagePlace place;
};

/// One message of a video, good image or not.
struct IndexedPacket {
  MessagePlace place;
  bool is_key_frame = false, has_parameter_sets = false;
};

/// All good images of one camera.
struct IndexedCamera {
  std::string name;
  SensorStream stream;
  std::vector<IndexedImage> images;    ///< strictly increasing in time
  std::vector<IndexedPacket> packets;  ///< in the order of the log; empty where it is no video
};

/// Where each image of a log lies, so that one can be read without the others.
struct PictureIndex {
  std::vector<IndexedCamera> cameras;
};

/// Reads the log once, and videos twice, without decoding images. The stamps that a drive drops
/// (TimestampFilter) are not in it. Throws Error{kInvalidInput} as SelectStreams does.
PictureIndex IndexPictures(const MessageSource& source, const Rig& rig);

/// JSON: {"cameras": [{"name", "time_shift" [s], "times": [ns, ...], ...}]}
std::string EncodePictureIndex(const PictureIndex& index);
/// Throws Error{kInvalidInput} for anything else.
PictureIndex DecodePictureIndex(const std::string& text);

}  // namespace parkade

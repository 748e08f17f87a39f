#pragma once

#include <memory>
#include <optional>

#include "server/ingest/containers/raw_message.h"
#include "server/ingest/messages/decoded_image.h"
#include "server/ingest/messages/sensor_stream.h"
#include "server/ingest/video/video_track.h"

namespace parkade {

/// An image as it lies in the log: encoded bytes of a message, or the path of a file. Where it is
/// one of a video, what is needed to decode it comes with it.
struct EncodedImage {
  RawMessage message;
  std::shared_ptr<VideoTrack> track;  ///< null: the image stands by itself
  std::shared_ptr<VideoFrame> frame;  ///< of the track
};

/// The message as a packet of video, or nothing where it is none.
std::optional<VideoPacket> VideoPacketOf(const RawMessage& message, const SensorStream& stream);

/// Decodes an image, whatever its type and encoding. Never throws on bad data. Thread-safe.
DecodedImage DecodeEncoded(const EncodedImage& image, const SensorStream& stream,
                           const ImageRequest& request);

/// Receives the messages of one topic of images in the order of the log, all of them: a video
/// cannot do without one.
class ImageIntake {
 public:
  EncodedImage Take(RawMessage message, const SensorStream& stream);

 private:
  std::shared_ptr<VideoTrack> track_;
};

}  // namespace parkade

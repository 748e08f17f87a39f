#include "server/ingest/video/encoded_image.h"

#include <optional>
#include <utility>

#include "core/error.h"
#include "server/ingest/messages/image_decoding.h"
#include "server/ingest/messages/message_decoding.h"

namespace parkade {

std::optional<VideoPacket> VideoPacketOf(const RawMessage& message, const SensorStream& stream) {
  if (stream.encoding == MessageEncoding::kEuroc || !IsCompressedImageType(stream.type))
    return std::nullopt;
  try {
    const CompressedImageMessage image =
        DecodeCompressedImage(message.data, stream.encoding, stream.type);
    return AsVideoPacket(image.format, image.data);
  } catch (const Error&) {
    return std::nullopt;  // what is wrong with the message is said when its image is wanted
  }
}

DecodedImage DecodeEncoded(const EncodedImage& image, const SensorStream& stream,
                           const ImageRequest& request) {
  return image.track ? image.track->Decode(image.frame, request)
                     : DecodeMessageImage(image.message, stream, request);
}

EncodedImage ImageIntake::Take(RawMessage message, const SensorStream& stream) {
  std::optional<VideoPacket> packet = VideoPacketOf(message, stream);
  if (!packet) return {std::move(message), nullptr, nullptr};
  if (!track_) track_ = std::make_shared<VideoTrack>();
  return {std::move(message), track_, track_->Add(std::move(*packet))};
}

}  // namespace parkade

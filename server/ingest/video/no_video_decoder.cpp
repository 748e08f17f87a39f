// Stands in for video_decoder.cpp where Parkade is built without libavcodec (PARKADE_VIDEO=OFF).
#include "server/ingest/video/video_decoder.h"

namespace parkade {

class VideoDecoder::Codec {};

VideoDecoder::VideoDecoder() = default;
VideoDecoder::~VideoDecoder() = default;

DecodedImage VideoDecoder::Decode(const VideoPacket& packet, const ImageRequest&) {
  return {{},
          ImageFault::kDamaged,
          packet.CodecName() + " video, which this build of Parkade does not decode: record JPEG"};
}

void VideoDecoder::Skip(const VideoPacket&) {}
void VideoDecoder::Note(const VideoPacket&) {}

}  // namespace parkade

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/ingest/messages/decoded_image.h"
#include "server/ingest/video/video_packet.h"

namespace parkade {

/// Decodes one video, packet by packet in the order in which they were recorded, each with one
/// image.
///
/// Behind a lost or damaged packet, as far as libavcodec notices (a gap in the numbers of the
/// frames, a reference that is missing, code that contradicts itself), all images count as damaged
/// up to the next key frame. Runs in the calling thread alone. Not thread-safe.
class VideoDecoder {
 public:
  VideoDecoder();
  ~VideoDecoder();
  VideoDecoder(const VideoDecoder&) = delete;
  VideoDecoder& operator=(const VideoDecoder&) = delete;

  /// The image of the next packet. Never throws on bad data.
  DecodedImage Decode(const VideoPacket& packet, const ImageRequest& request);

  /// Decodes the next packet for the sake of those behind it.
  void Skip(const VideoPacket& packet);

  /// Takes note of what a packet says about those behind it, without decoding it: the next one to
  /// be decoded has to be a key frame.
  void Note(const VideoPacket& packet);

 private:
  class Codec;

  /// Decodes a packet into the codec's frame; the fault where there is no sound one.
  DecodedImage Advance(const VideoPacket& packet);

  std::unique_ptr<Codec> codec_;
  VideoCodec kind_ = VideoCodec::kOther;      ///< of codec_
  std::vector<std::uint8_t> parameter_sets_;  ///< the latest
  DecodedImage fault_;                        ///< of all images up to the next key frame
};

}  // namespace parkade

#include "server/ingest/video/video_decoder.h"

/// Decodes bytes as two packets of each codec, which the first byte divides.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace parkade;
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const std::size_t middle = bytes.size() * data[0] / 256;
  for (const char* format : {"h264", "h265"}) {
    VideoDecoder decoder;
    for (const auto part : {bytes.first(middle), bytes.subspan(middle)})
      if (const auto packet = AsVideoPacket(format, part)) decoder.Decode(*packet, {});
  }
  return 0;
}

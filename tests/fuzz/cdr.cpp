#include <string>

#include "core/error.h"
#include "server/ingest/messages/message_decoding.h"

namespace parkade {
namespace {

using Decoder = void (*)(std::span<const std::uint8_t>, MessageEncoding);

constexpr Decoder kDecoders[] = {
    [](auto data, MessageEncoding encoding) { DecodeHeader(data, encoding, "sensor_msgs/Imu"); },
    [](auto data, MessageEncoding encoding) { DecodeImu(data, encoding); },
    [](auto data, MessageEncoding encoding) {
      DecodeOdometry(data, encoding, "nav_msgs/Odometry");
    },
    [](auto data, MessageEncoding encoding) {
      DecodeOdometry(data, encoding, "geometry_msgs/TwistStamped");
    },
    [](auto data, MessageEncoding encoding) { DecodeNavSat(data, encoding); },
    [](auto data, MessageEncoding encoding) { DecodeCameraInfo(data, encoding); },
    [](auto data, MessageEncoding encoding) { DecodeTransforms(data, encoding); },
    [](auto data, MessageEncoding encoding) { DecodeImage(data, encoding); },
    [](auto data, MessageEncoding encoding) {
      DecodeCompressedImage(data, encoding, "sensor_msgs/CompressedImage");
    }};

}  // namespace
}  // namespace parkade

/// Reads bytes as each of the messages, in the two encodings.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace parkade;
  for (const MessageEncoding encoding : {MessageEncoding::kCdr, MessageEncoding::kRos1})
    for (const Decoder decode : kDecoders) try {
        decode({data, size}, encoding);
      } catch (const Error&) {  // a clear refusal
      }
  return 0;
}

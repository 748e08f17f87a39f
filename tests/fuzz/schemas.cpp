#include <string>

#include "core/error.h"
#include "server/ingest/schemas/foxglove_messages.h"
#include "server/ingest/schemas/message_path.h"
#include "server/ingest/schemas/message_schema.h"

namespace parkade {
namespace {

constexpr MessageEncoding kEncodings[] = {MessageEncoding::kCdr, MessageEncoding::kRos1,
                                          MessageEncoding::kProtobuf, MessageEncoding::kJson};
constexpr const char* kTypes[] = {"CompressedImage", "RawImage",        "CameraCalibration",
                                  "FrameTransform",  "FrameTransforms", "LocationFix"};

/// Reads a message by a schema, and what Parkade asks of one.
void Read(const TopicInfo& topic, std::span<const std::uint8_t> data) {
  const MessageTree tree = ReadSchema(topic)->Decode(data);
  ListNumbers(tree);
  StampIn(tree);
  for (const char* path : {"velocity[name=a]", "a[0].b", "x"}) {
    MessagePath(path).Number(tree);
    MessagePath(path).NamesInstead(tree);
  }
  for (const char* type : kTypes) try {
      ToRosMessage(tree, std::string("foxglove.") + type);
    } catch (const Error&) {  // a clear refusal
    }
}

}  // namespace
}  // namespace parkade

/// A byte for the encoding, two for the length of the schema; the schema and a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace parkade;
  constexpr std::size_t kHead = 3;
  if (size < kHead) return 0;
  const std::span<const std::uint8_t> rest(data + kHead, size - kHead);
  const std::size_t length = std::min<std::size_t>(data[1] | data[2] << 8, rest.size());
  const TopicInfo topic{
      .topic = "/t",
      .type = data[0] % 4 == 2 ? "p.T" : "p/T",
      .encoding = kEncodings[data[0] % 4],
      .schema = std::make_shared<const std::string>(rest.begin(), rest.begin() + length)};
  try {
    Read(topic, rest.subspan(length));
  } catch (const Error&) {  // a clear refusal
  }
  return 0;
}

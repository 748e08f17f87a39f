#include "server/ingest/schemas/foxglove_messages.h"

#include <cmath>

#include "core/error.h"
#include "server/ingest/schemas/message_path.h"
#include "server/ingest/writing/cdr_writer.h"

namespace parkade {
namespace {

/// Within what a field of the type may hold; beyond, and for NaN, 0.
template <typename T>
T WholeAt(const MessageTree& message, const char* path) {
  const double number = NumberAt(message, path);
  const bool is_in_range = number >= static_cast<double>(std::numeric_limits<T>::min()) &&
                           number <= static_cast<double>(std::numeric_limits<T>::max());
  return is_in_range ? static_cast<T>(number) : T{0};
}

CdrWriter BeginMessage(const MessageTree& message) {
  CdrWriter writer;
  writer.Header(StampIn(message), TextAt(message, "frame_id"));
  return writer;
}

std::vector<std::uint8_t> CompressedImage(const MessageTree& message) {
  CdrWriter writer = BeginMessage(message);
  return writer.Text(TextAt(message, "format")).Bytes(BytesAt(message, "data")).Take();
}

std::vector<std::uint8_t> RawImage(const MessageTree& message) {
  CdrWriter writer = BeginMessage(message);
  writer.Put(WholeAt<std::uint32_t>(message, "height"));
  writer.Put(WholeAt<std::uint32_t>(message, "width"));
  writer.Text(TextAt(message, "encoding")).Put(std::uint8_t{0});  // little endian
  writer.Put(WholeAt<std::uint32_t>(message, "step"));
  return writer.Bytes(BytesAt(message, "data")).Take();
}

/// The numbers of a field; ROS 2 knows no capital letters.
std::vector<double> EitherNumbersAt(const MessageTree& message, const std::string& field) {
  std::vector<double> numbers = NumbersAt(message, field);
  if (!numbers.empty()) return numbers;
  std::string small = field;
  small.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(small.front())));
  return NumbersAt(message, small);
}

/// The numbers of a matrix, zeros where it is left out.
template <std::size_t kCount>
std::array<double, kCount> MatrixAt(const MessageTree& message, const std::string& field) {
  const std::vector<double> numbers = EitherNumbersAt(message, field);
  Require(numbers.empty() || numbers.size() == kCount, ErrorCode::kInvalidInput,
          "the matrix " + field + " has " + std::to_string(numbers.size()) + " numbers");
  std::array<double, kCount> matrix{};
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
  return matrix;
}

std::vector<std::uint8_t> CameraCalibration(const MessageTree& message) {
  CdrWriter writer = BeginMessage(message);
  writer.Put(WholeAt<std::uint32_t>(message, "height"));
  writer.Put(WholeAt<std::uint32_t>(message, "width"));
  writer.Text(TextAt(message, "distortion_model"));
  const std::vector<double> distortion = EitherNumbersAt(message, "D");
  writer.Put(static_cast<std::uint32_t>(distortion.size())).Doubles(distortion);
  writer.Doubles(MatrixAt<9>(message, "K")).Doubles(MatrixAt<9>(message, "R"));
  writer.Doubles(MatrixAt<12>(message, "P"));
  for (int i = 0; i < 6; ++i) writer.Put(std::uint32_t{0});  // binning, region of interest
  return writer.Put(std::uint8_t{0}).Take();
}

std::vector<std::uint8_t> Transforms(const std::vector<MessageTree>& transforms) {
  CdrWriter writer;
  writer.Put(static_cast<std::uint32_t>(transforms.size()));
  for (const MessageTree& transform : transforms) {
    writer.Header(StampIn(transform), TextAt(transform, "parent_frame_id"));
    writer.Text(TextAt(transform, "child_frame_id"));
    for (const char* path : {"translation.x", "translation.y", "translation.z", "rotation.x",
                             "rotation.y", "rotation.z", "rotation.w"})
      writer.Put(NumberAt(transform, path));
  }
  return writer.Take();
}

std::vector<std::uint8_t> FrameTransforms(const MessageTree& message) {
  const auto found = message.is_object() ? message.find("transforms") : message.end();
  if (found == message.end() || !found->is_array()) return Transforms({});
  return Transforms({found->begin(), found->end()});
}

std::vector<std::uint8_t> LocationFix(const MessageTree& message) {
  CdrWriter writer = BeginMessage(message);
  writer.Put(std::int8_t{0}).Put(std::uint16_t{1});  // a fix, GPS
  for (const char* path : {"latitude", "longitude", "altitude"})
    writer.Put(NumberAt(message, path));
  writer.Doubles(MatrixAt<9>(message, "position_covariance"));
  return writer.Put(WholeAt<std::uint8_t>(message, "position_covariance_type")).Take();
}

using Translation = std::vector<std::uint8_t> (*)(const MessageTree&);

struct FoxgloveType {
  const char* name;
  const char* ros_type;
  Translation translate;
};

constexpr FoxgloveType kTypes[] = {
    {"CompressedImage", "sensor_msgs/CompressedImage", CompressedImage},
    {"CompressedVideo", "sensor_msgs/CompressedImage", CompressedImage},
    {"RawImage", "sensor_msgs/Image", RawImage},
    {"CameraCalibration", "sensor_msgs/CameraInfo", CameraCalibration},
    {"FrameTransform", "tf2_msgs/TFMessage",
     [](const MessageTree& message) { return Transforms({message}); }},
    {"FrameTransforms", "tf2_msgs/TFMessage", FrameTransforms},
    {"LocationFix", "sensor_msgs/NavSatFix", LocationFix},
};

const FoxgloveType* FindType(std::string_view name) {
  for (const std::string_view package : {"foxglove.", "foxglove_msgs/"}) {
    if (!name.starts_with(package)) continue;
    name.remove_prefix(package.size());
    for (const FoxgloveType& type : kTypes)
      if (type.name == name) return &type;
  }
  return nullptr;
}

}  // namespace

std::string RosTypeFor(const std::string& type) {
  const FoxgloveType* found = FindType(type);
  return found != nullptr ? found->ros_type : "";
}

std::vector<std::uint8_t> ToRosMessage(const MessageTree& message, const std::string& type) {
  const FoxgloveType* found = FindType(type);
  Require(found != nullptr, ErrorCode::kInternal, type + " is no type of Foxglove's");
  Require(message.is_object(), ErrorCode::kInvalidInput, "the message has no fields");
  return found->translate(message);
}

}  // namespace parkade

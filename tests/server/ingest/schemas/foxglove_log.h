#pragma once

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/timestamp.pb.h>
#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "core/error.h"
#include "server/ingest/writing/mcap_writer.h"

namespace parkade {

/// Foxglove's types as far as they are read, and one of a car's maker: "Type: form name, form
/// name"; a star stands for a repeated field. Fields are numbered in this order.
inline constexpr const char* kFoxgloveTypes[] = {
    "Vector3: double x, double y, double z",
    "Quaternion: double x, double y, double z, double w",
    "CompressedImage: Time timestamp, string frame_id, bytes data, string format",
    "CompressedVideo: Time timestamp, string frame_id, bytes data, string format",
    "RawImage: Time timestamp, string frame_id, fixed32 width, fixed32 height, string encoding, "
    "fixed32 step, bytes data",
    "CameraCalibration: Time timestamp, string frame_id, fixed32 width, fixed32 height, "
    "string distortion_model, double* D, double* K, double* R, double* P",
    "FrameTransform: Time timestamp, string parent_frame_id, string child_frame_id, "
    "Vector3 translation, Quaternion rotation",
    "FrameTransforms: FrameTransform* transforms",
    "LocationFix: Time timestamp, string frame_id, double latitude, double longitude, "
    "double altitude, double* position_covariance, int32 position_covariance_type",
    "Wheel: string name, float speed",
    "CarState: Time timestamp, Wheel* wheels, Vector3 rates, int64 ticks_left, int64 ticks_right, "
    "CarState recursive, double* can"};

/// Adds a line of kFoxgloveTypes to a file of package foxglove.
inline void AddType(const std::string& line, google::protobuf::FileDescriptorProto& file) {
  using Field = google::protobuf::FieldDescriptorProto;
  static const std::map<std::string, Field::Type> kForms = {
      {"double", Field::TYPE_DOUBLE},   {"float", Field::TYPE_FLOAT},
      {"int32", Field::TYPE_INT32},     {"int64", Field::TYPE_INT64},
      {"fixed32", Field::TYPE_FIXED32}, {"string", Field::TYPE_STRING},
      {"bytes", Field::TYPE_BYTES}};
  google::protobuf::DescriptorProto& type = *file.add_message_type();
  std::istringstream words(line);
  std::string name, form;
  words >> name;
  type.set_name(name.substr(0, name.size() - 1));
  while (words >> form >> name) {
    Field& field = *type.add_field();
    if (name.back() == ',') name.pop_back();
    const bool is_repeated = form.back() == '*';
    if (is_repeated) form.pop_back();
    field.set_name(name);
    field.set_number(type.field_size());
    field.set_label(is_repeated ? Field::LABEL_REPEATED : Field::LABEL_OPTIONAL);
    const auto known = kForms.find(form);
    field.set_type(known != kForms.end() ? known->second : Field::TYPE_MESSAGE);
    if (known == kForms.end())
      field.set_type_name(form == "Time" ? ".google.protobuf.Timestamp" : ".foxglove." + form);
  }
}

/// A new folder for the logs of one test.
inline std::filesystem::path MakeSchemaFolder() {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("parkade_schemas_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  return folder;
}

/// Writes an MCAP log whose messages are given as JSON, in protobuf or as they are. Stamps are
/// those of the log: `timestamp` is put into each message.
class FoxgloveLog {
 public:
  /// \param encoding  "protobuf" or "json"
  FoxgloveLog(const std::filesystem::path& file, std::string encoding)
      : encoding_(std::move(encoding)), writer_(file, "") {
    google::protobuf::FileDescriptorProto& types = *files_.add_file();
    types.set_package("foxglove");
    types.set_syntax("proto3");
    types.add_dependency("google/protobuf/timestamp.proto");
    for (const char* line : kFoxgloveTypes) AddType(line, types);
    types.set_name("foxglove.proto");
    google::protobuf::Timestamp::descriptor()->file()->CopyTo(files_.add_file());  // after its use
    pool_.BuildFile(files_.file(1));
    pool_.BuildFile(files_.file(0));
  }

  void Add(const std::string& topic, const std::string& type, Timestamp time,
           nlohmann::json message) {
    const int channel = ChannelOf(topic, type);
    if (encoding_ == "json") {
      message["timestamp"] = {{"sec", time.ns / kSecond}, {"nsec", time.ns % kSecond}};
      return WriteText(channel, time, message.dump());
    }
    const auto* descriptor = pool_.FindMessageTypeByName("foxglove." + type);
    const std::unique_ptr<google::protobuf::Message> proto(
        factory_.GetPrototype(descriptor)->New());
    const auto status = google::protobuf::util::JsonStringToMessage(message.dump(), proto.get());
    Require(status.ok(), ErrorCode::kInternal, status.ToString());
    if (const auto* field = descriptor->FindFieldByName("timestamp")) {
      auto* stamp = proto->GetReflection()->MutableMessage(proto.get(), field);
      const auto& fields = *stamp->GetDescriptor();
      stamp->GetReflection()->SetInt64(stamp, fields.field(0), time.ns / kSecond);
      stamp->GetReflection()->SetInt32(stamp, fields.field(1),
                                       static_cast<std::int32_t>(time.ns % kSecond));
    }
    WriteText(channel, time, proto->SerializeAsString());
  }

  /// For channels of other encodings.
  McapWriter& writer() { return writer_; }
  void Close() { writer_.Close(); }

 private:
  static constexpr std::int64_t kSecond = 1'000'000'000;

  int ChannelOf(const std::string& topic, const std::string& type) {
    const auto found = channels_.find(topic);
    if (found != channels_.end()) return found->second;
    const std::string schema = encoding_ == "json" ? "{}" : files_.SerializeAsString();
    return channels_[topic] = writer_.AddChannel(topic, "foxglove." + type, schema, encoding_);
  }

  void WriteText(int channel, Timestamp time, const std::string& text) {
    writer_.Write(channel, time, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  std::string encoding_;
  McapWriter writer_;
  google::protobuf::FileDescriptorSet files_;
  google::protobuf::DescriptorPool pool_;
  google::protobuf::DynamicMessageFactory factory_;
  std::map<std::string, int> channels_;
};

}  // namespace parkade

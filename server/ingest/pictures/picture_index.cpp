#include "server/ingest/pictures/picture_index.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/ingest/drive/arrival_stream.h"
#include "server/ingest/drive/stream_selection.h"
#include "server/ingest/messages/image_decoding.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

constexpr int kVersion = 3;
constexpr int kMaxSampleBits = 16;

void Append(const MessagePlace& place, Json& places) {
  for (const std::uint64_t number : {place.record, place.in_chunk, place.part})
    places.push_back(number);
}

/// The places that Append() wrote, `count` of them.
std::vector<MessagePlace> PlacesOf(const Json& json, std::size_t count) {
  const auto numbers = json.get<std::vector<std::uint64_t>>();
  Require(numbers.size() == 3 * count, ErrorCode::kInvalidInput,
          "the index of pictures is damaged");
  std::vector<MessagePlace> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
  return places;
}

Json ToJson(const IndexedCamera& camera) {
  Json times = Json::array(), places = Json::array();
  for (const IndexedImage& image : camera.images) {
    times.push_back(image.time.ns);
    Append(image.place, places);
  }
  Json packets = Json::array(), key_frames = Json::array(), parameter_sets = Json::array();
  for (std::size_t i = 0; i < camera.packets.size(); ++i) {
    Append(camera.packets[i].place, packets);
    if (camera.packets[i].is_key_frame) key_frames.push_back(i);
    if (camera.packets[i].has_parameter_sets) parameter_sets.push_back(i);
  }
  const SensorStream& stream = camera.stream;
  return {{"name", camera.name},
          {"topic", stream.topic},
          {"type", stream.type},
          {"encoding", static_cast<int>(stream.encoding)},
          {"time_shift", stream.time_shift},
          {"sample_bits", stream.sample_bits},
          {"times", std::move(times)},
          {"places", std::move(places)},
          {"packets", std::move(packets)},
          {"key_frames", std::move(key_frames)},
          {"parameter_sets", std::move(parameter_sets)}};
}

IndexedPacket& PacketAt(std::size_t i, IndexedCamera& camera) {
  Require(i < camera.packets.size(), ErrorCode::kInvalidInput, "the index of pictures is damaged");
  return camera.packets[i];
}

IndexedCamera CameraOf(const Json& json) {
  IndexedCamera camera;
  camera.name = json.at("name");
  camera.stream.kind = StreamKind::kImage;
  camera.stream.topic = json.at("topic");
  camera.stream.type = json.at("type");
  camera.stream.encoding = static_cast<MessageEncoding>(json.at("encoding").get<int>());
  camera.stream.time_shift = json.at("time_shift");
  camera.stream.sample_bits = json.at("sample_bits");
  const auto times = json.at("times").get<std::vector<std::int64_t>>();
  const std::vector<MessagePlace> places = PlacesOf(json.at("places"), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) camera.images.push_back({{times[i]}, places[i]});
  const Json& packets = json.at("packets");
  for (const MessagePlace& place : PlacesOf(packets, packets.size() / 3))
    camera.packets.push_back({place});
  for (const std::size_t i : json.at("key_frames").get<std::vector<std::size_t>>())
    PacketAt(i, camera).is_key_frame = true;
  for (const std::size_t i : json.at("parameter_sets").get<std::vector<std::size_t>>())
    PacketAt(i, camera).has_parameter_sets = true;
  return camera;
}

/// The messages of a camera's video; none where it is none.
std::vector<IndexedPacket> PacketsOf(const MessageSource& source, const SensorStream& stream) {
  std::vector<bool> wanted(source.topics().size(), false);
  wanted[static_cast<std::size_t>(stream.topic)] = true;
  std::vector<IndexedPacket> packets;
  const auto messages = source.Read(wanted);
  while (const std::optional<RawMessage> message = messages->Next())
    if (const std::optional<VideoPacket> packet = VideoPacketOf(*message, stream))
      packets.push_back({message->place, packet->is_key_frame, !packet->parameter_sets.empty()});
  return packets;
}

}  // namespace

PictureIndex IndexPictures(const MessageSource& source, const Rig& rig) {
  const std::vector<SensorStream> streams =
      SelectStreams(source, rig, /*use_wheels=*/false, /*use_gnss=*/false).streams;
  std::vector<bool> wanted;
  std::vector<int> camera_of_stream;
  PictureIndex index;
  for (const SensorStream& stream : streams) {
    const bool is_camera = stream.kind == StreamKind::kImage;
    wanted.push_back(is_camera);
    camera_of_stream.push_back(is_camera ? static_cast<int>(index.cameras.size()) : -1);
    if (is_camera)
      index.cameras.push_back(
          {rig.cameras[static_cast<size_t>(stream.camera)].name, stream, {}, {}});
  }
  std::vector<int> sample_bits(index.cameras.size());
  std::vector<bool> is_video(index.cameras.size());
  ArrivalStream arrivals(source, streams, wanted, nullptr);
  while (const std::optional<Arrival> arrival = arrivals.Next()) {
    const auto number = static_cast<size_t>(camera_of_stream[static_cast<size_t>(arrival->stream)]);
    IndexedCamera& camera = index.cameras[number];
    const auto& [message, track, frame] = std::get<EncodedImage>(arrival->content);
    if (track) is_video[number] = true;
    camera.images.push_back({arrival->time, message.place});
    sample_bits[number] =
        std::max(sample_bits[number], SampleBits(message, camera.stream).value_or(0));
  }
  for (size_t i = 0; i < index.cameras.size(); ++i) {
    IndexedCamera& camera = index.cameras[i];
    camera.stream.sample_bits = sample_bits[i] > 0 ? sample_bits[i] : kMaxSampleBits;
    if (is_video[i]) camera.packets = PacketsOf(source, camera.stream);
  }
  return index;
}

std::string EncodePictureIndex(const PictureIndex& index) {
  Json cameras = Json::array();
  for (const IndexedCamera& camera : index.cameras) cameras.push_back(ToJson(camera));
  return Json{{"version", kVersion}, {"cameras", std::move(cameras)}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

PictureIndex DecodePictureIndex(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    Require(json.at("version") == kVersion, ErrorCode::kInvalidInput,
            "the index of pictures is of another version");
    PictureIndex index;
    for (const Json& camera : json.at("cameras")) index.cameras.push_back(CameraOf(camera));
    return index;
  } catch (const Json::exception&) {
    throw Error(ErrorCode::kInvalidInput, "the index of pictures is damaged");
  }
}

}  // namespace parkade

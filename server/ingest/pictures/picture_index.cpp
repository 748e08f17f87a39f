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

constexpr int kVersion = 1;
constexpr int kMaxSampleBits = 16;

Json ToJson(const IndexedCamera& camera) {
  Json times = Json::array(), places = Json::array();
  for (const IndexedImage& image : camera.images) {
    times.push_back(image.time.ns);
    for (const std::uint64_t number : {image.place.record, image.place.in_chunk, image.place.part})
      places.push_back(number);
  }
  const SensorStream& stream = camera.stream;
  return {{"name", camera.name},
          {"topic", stream.topic},
          {"type", stream.type},
          {"encoding", static_cast<int>(stream.encoding)},
          {"time_shift", stream.time_shift},
          {"sample_bits", stream.sample_bits},
          {"times", std::move(times)},
          {"places", std::move(places)}};
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
  const auto places = json.at("places").get<std::vector<std::uint64_t>>();
  Require(places.size() == 3 * times.size(), ErrorCode::kInvalidInput,
          "the index of pictures is damaged");
  for (size_t i = 0; i < times.size(); ++i)
    camera.images.push_back({{times[i]}, {places[3 * i], places[3 * i + 1], places[3 * i + 2]}});
  return camera;
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
      index.cameras.push_back({rig.cameras[static_cast<size_t>(stream.camera)].name, stream, {}});
  }
  std::vector<int> sample_bits(index.cameras.size());
  ArrivalStream arrivals(source, streams, wanted, nullptr);
  while (const std::optional<Arrival> arrival = arrivals.Next()) {
    const auto number = static_cast<size_t>(camera_of_stream[static_cast<size_t>(arrival->stream)]);
    IndexedCamera& camera = index.cameras[number];
    const RawMessage& message = std::get<EncodedImage>(arrival->content).message;
    camera.images.push_back({arrival->time, message.place});
    sample_bits[number] =
        std::max(sample_bits[number], SampleBits(message, camera.stream).value_or(0));
  }
  for (size_t i = 0; i < index.cameras.size(); ++i)
    index.cameras[i].stream.sample_bits = sample_bits[i] > 0 ? sample_bits[i] : kMaxSampleBits;
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

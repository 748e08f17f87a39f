#include "server/ingest/pictures/read_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "server/ingest/video/encoded_image.h"

namespace parkade {
namespace {

constexpr int kJpegQuality = 85;

cv::Mat AtMostAsWide(const cv::Mat& image, int max_width) {
  if (max_width <= 0 || image.cols <= max_width) return image;
  const double factor = static_cast<double>(max_width) / image.cols;
  const int height = std::max(1, static_cast<int>(std::lround(image.rows * factor)));
  cv::Mat small;
  cv::resize(image, small, {max_width, height}, 0, 0, cv::INTER_AREA);
  return small;
}

bool IsSame(const MessagePlace& a, const MessagePlace& b) {
  return a.record == b.record && a.in_chunk == b.in_chunk && a.part == b.part;
}

/// Where the messages lie that an image is decoded from, itself the last: those of a video from the
/// key frame before it, and what described the video before that.
std::vector<MessagePlace> PlacesNeeded(const IndexedCamera& camera, const IndexedImage& image) {
  const auto packet = std::ranges::find_if(camera.packets, [&](const IndexedPacket& candidate) {
    return IsSame(candidate.place, image.place);
  });
  if (packet == camera.packets.end()) return {image.place};
  auto begin = packet;
  while (begin != camera.packets.begin() && !begin->is_key_frame) --begin;
  std::vector<MessagePlace> places;
  if (!begin->has_parameter_sets) {
    auto description = begin;
    while (description != camera.packets.begin() && !description->has_parameter_sets) --description;
    if (description != begin) places.push_back(description->place);
  }
  for (auto it = begin; it <= packet; ++it) places.push_back(it->place);
  return places;
}

}  // namespace

Picture ReadPicture(const MessageSource& source, const IndexedCamera& camera,
                    const IndexedImage& image, int max_width) {
  const std::string name = "the image of " + camera.name + " at " + ToDecimalSeconds(image.time);
  const auto num_topics = static_cast<int>(source.topics().size());
  Require(camera.stream.topic >= 0 && camera.stream.topic < num_topics, ErrorCode::kInvalidInput,
          name + " is of a topic that the log does not have");
  ImageIntake intake;
  std::optional<EncodedImage> encoded;
  for (const MessagePlace& place : PlacesNeeded(camera, image)) {
    std::optional<RawMessage> message = source.ReadAt(camera.stream.topic, place);
    Require(message.has_value(), ErrorCode::kInvalidInput, name + " cannot be read from the log");
    encoded = intake.Take(std::move(*message), camera.stream);
  }
  const DecodedImage decoded = DecodeEncoded(
      *encoded, camera.stream, {.grayscale = false, .sample_bits = camera.stream.sample_bits});
  Require(decoded.fault == ImageFault::kNone, ErrorCode::kInvalidInput,
          name + " is damaged: " + decoded.what);
  const cv::Mat shown = AtMostAsWide(decoded.image, max_width);
  std::vector<unsigned char> bytes;
  Require(cv::imencode(".jpg", shown, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality}),
          ErrorCode::kInternal, name + " cannot be encoded");
  return {
      {bytes.begin(), bytes.end()}, shown.cols, shown.rows, decoded.image.cols, decoded.image.rows};
}

}  // namespace parkade

#include "server/ingest/pictures/read_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "server/ingest/messages/image_decoding.h"

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

}  // namespace

Picture ReadPicture(const MessageSource& source, const IndexedCamera& camera,
                    const IndexedImage& image, int max_width) {
  const std::string name = "the image of " + camera.name + " at " + ToDecimalSeconds(image.time);
  const auto num_topics = static_cast<int>(source.topics().size());
  Require(camera.stream.topic >= 0 && camera.stream.topic < num_topics, ErrorCode::kInvalidInput,
          name + " is of a topic that the log does not have");
  const std::optional<RawMessage> message = source.ReadAt(camera.stream.topic, image.place);
  Require(message.has_value(), ErrorCode::kInvalidInput, name + " cannot be read from the log");
  const DecodedImage decoded = DecodeMessageImage(
      *message, camera.stream, {.grayscale = false, .sample_bits = camera.stream.sample_bits});
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

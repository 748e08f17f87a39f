#include "server/ingest/conversion/clean_message.h"

#include <limits>

#include "core/files/file.h"
#include "server/ingest/messages/image_decoding.h"
#include "server/ingest/messages/message_encoding.h"

namespace parkade {
namespace {

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressedImage = "sensor_msgs/CompressedImage";

CleanMessage MessageOf(const GnssFix& fix) {
  constexpr int kDiagonalKnown = 2;
  NavSatMessage message{.header = {fix.time, "gnss"},
                        .status = 0,
                        .latitude_deg = fix.latitude_deg,
                        .longitude_deg = fix.longitude_deg,
                        .altitude = fix.altitude,
                        .covariance = {},
                        .covariance_type = kDiagonalKnown};
  if (!fix.HasAltitude()) message.altitude = std::numeric_limits<double>::quiet_NaN();
  for (int axis = 0; axis < 3; ++axis)
    message.covariance[static_cast<std::size_t>(4 * axis)] =
        fix.sigma_enu[axis] * fix.sigma_enu[axis];
  return {"sensor_msgs/NavSatFix", EncodeNavSat(message)};
}

/// An image of a video: nobody but its neighbors could say what its bytes mean.
CleanMessage MessageOf(const cv::Mat& image, const MessageHeader& header) {
  const cv::Mat pixels = image.isContinuous() ? image : image.clone();
  const std::size_t step = pixels.elemSize() * static_cast<std::size_t>(pixels.cols);
  const std::size_t size = step * static_cast<std::size_t>(pixels.rows);
  return {kImage, EncodeImage({.header = header,
                               .width = static_cast<std::uint32_t>(pixels.cols),
                               .height = static_cast<std::uint32_t>(pixels.rows),
                               .step = static_cast<std::uint32_t>(step),
                               .encoding = pixels.channels() == 1 ? "mono8" : "bgr8",
                               .is_bigendian = false,
                               .data = {pixels.data, size}})};
}

CleanMessage MessageOf(std::span<const std::uint8_t> file, const MessageHeader& header) {
  return {kCompressedImage, EncodeCompressedImage({header, IsPng(file) ? "png" : "jpeg", file})};
}

/// A sound image as it lies in the log.
CleanMessage MessageOf(const RawMessage& message, const SensorStream& stream,
                       const MessageHeader& header) {
  if (stream.encoding == MessageEncoding::kEuroc) {
    const std::string file = ReadFile(std::string(message.data.begin(), message.data.end()));
    return MessageOf({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, header);
  }
  if (stream.type != kImage)
    return MessageOf(DecodeCompressedImage(message.data, stream.encoding, stream.type).data,
                     header);
  ImageMessage image = DecodeImage(message.data, stream.encoding);
  image.header = header;
  return {kImage, EncodeImage(image)};
}

std::optional<CleanMessage> MessageOf(const EncodedImage& image, Timestamp time,
                                      const SensorStream& stream, const RigCamera& camera) {
  const bool is_video = image.track != nullptr;
  const DecodedImage decoded = DecodeEncoded(image, stream,
                                             {.width = camera.model.width(),
                                              .height = camera.model.height(),
                                              .grayscale = !is_video,
                                              .sample_bits = stream.sample_bits});
  if (decoded.fault != ImageFault::kNone) return std::nullopt;
  const MessageHeader header{time, camera.name};
  return is_video ? MessageOf(decoded.image, header) : MessageOf(image.message, stream, header);
}

}  // namespace

std::optional<CleanMessage> MakeCleanMessage(const Arrival& arrival, const SensorStream& stream,
                                             const Rig& rig) {
  if (const auto* image = std::get_if<EncodedImage>(&arrival.content))
    return MessageOf(*image, arrival.time, stream,
                     rig.cameras[static_cast<std::size_t>(stream.camera)]);
  if (const auto* imu = std::get_if<ImuSample>(&arrival.content))
    return CleanMessage{
        "sensor_msgs/Imu",
        EncodeImu({arrival.time, imu->angular_velocity, imu->linear_acceleration}, "imu")};
  if (const auto* wheels = std::get_if<WheelSample>(&arrival.content))
    return CleanMessage{
        "geometry_msgs/TwistStamped",
        EncodeTwist({arrival.time, wheels->forward_speed, wheels->yaw_rate}, "body")};
  GnssFix fix = std::get<GnssFix>(arrival.content);
  fix.time = arrival.time;
  return MessageOf(fix);
}

}  // namespace parkade

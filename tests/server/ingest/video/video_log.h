#pragma once

#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/rig.h"
#include "tests/server/ingest/messages/message_writer.h"
#include "tests/support/video_writer.h"

namespace parkade {

inline constexpr int kVideoWidth = 160, kVideoHeight = 96;

/// A bright disk on a slope of gray levels, which moves by 4 px from one image to the next.
inline cv::Mat MovingDisk(int number) {
  cv::Mat image(kVideoHeight, kVideoWidth, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(x / 2 + y);
  cv::circle(image, {20 + 4 * (number % 30), 48}, 12, 250, cv::FILLED);
  return image;
}

inline std::vector<cv::Mat> MovingDisks(int count) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < count; ++i) images.push_back(MovingDisk(i));
  return images;
}

/// [gray levels] mean of how far images are from each other.
inline double Difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

/// A message of `type` with a packet of video.
inline std::vector<std::uint8_t> VideoBytes(MessageWriter writer, MessageEncoding encoding,
                                            const std::string& type, std::int64_t stamp_ns,
                                            const std::string& format,
                                            const std::vector<std::uint8_t>& packet) {
  if (type == "foxglove_msgs/CompressedVideo" && encoding == MessageEncoding::kRos1) {
    writer.Put(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
    writer.Put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000)).Text("camera");
    return writer.Bytes(packet).Text(format).Take();
  }
  writer.Header(stamp_ns, "camera");
  if (type == "foxglove_msgs/CompressedVideo") return writer.Bytes(packet).Text(format).Take();
  if (type == "sensor_msgs/CompressedImage") return writer.Text(format).Bytes(packet).Take();
  writer.Put(std::int32_t{kVideoWidth}).Put(std::int32_t{kVideoHeight}).Text(format);
  writer.Put(std::uint64_t{5}).Put(std::uint8_t{1}).Put(std::uint8_t{0});
  return writer.Bytes(packet).Take();
}

/// A rig of an IMU and one camera, whose topic is /cam0/image_raw.
inline Rig RigOfVideo() {
  Rig rig;
  rig.imu.topic = "/imu";
  RigCamera& camera = rig.cameras.emplace_back();
  camera.name = "cam0";
  camera.topic = "/cam0/image_raw";
  camera.model = CameraModel(PinholeProjection{80, 80, 80, 48}, kVideoWidth, kVideoHeight);
  return rig;
}

}  // namespace parkade

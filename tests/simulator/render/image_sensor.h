#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace parkade::simulator {

struct ImageSensorOptions {
  double exposure =
      0;  ///< [s] moving things smear; 0: what a camera would choose in the light of the scene
  double noise = 1;       ///< scales shot and read noise
  int jpeg_quality = 90;  ///< 1..100

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("exposure", exposure);
    visit("noise", noise);
    visit("jpeg_quality", jpeg_quality);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Turns light into the image a camera gives out: automatic gain that follows
/// slowly, up to 24 dB, shot and read noise that grow with it, highlights that saturate softly,
/// sRGB.
class ImageSensor {
 public:
  ImageSensor(const ImageSensorOptions& options, std::uint64_t seed);

  /// `radiance` CV_32FC3 (red, green, blue); returns CV_8UC3 (BGR). Call in order of time.
  cv::Mat Develop(const cv::Mat& radiance);

 private:
  void FollowLight(const cv::Mat& radiance);
  double ExposureRatio() const;  ///< to that of daylight

  ImageSensorOptions options_;
  std::uint64_t seed_;
  std::uint64_t num_frames_ = 0;
  std::optional<double> gain_;
};

/// JPEG file of a CV_8UC3 or CV_8UC1 image.
std::vector<std::uint8_t> EncodeJpeg(const cv::Mat& image, int quality);
/// PNG file of a CV_8UC1 image.
std::vector<std::uint8_t> EncodePng(const cv::Mat& image);

}  // namespace parkade::simulator

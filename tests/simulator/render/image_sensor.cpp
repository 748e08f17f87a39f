#include "tests/simulator/render/image_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {
namespace {

constexpr int kCurveSteps = 4096;

// In full daylight a camera exposes for this long and amplifies the light of the scene so much.
constexpr double kDaylightExposure = 0.003, kDaylightGain = 2;  // [s]
constexpr double kMostAmplification = 16;                       // over that of daylight; 24 dB

/// From linear light, 1 = the brightest that is kept apart from saturation, to 8 bits.
const std::array<std::uint8_t, kCurveSteps>& ToneCurve() {
  static const std::array<std::uint8_t, kCurveSteps> curve = [] {
    std::array<std::uint8_t, kCurveSteps> made{};
    for (int i = 0; i < kCurveSteps; ++i) {
      const double light = 1.6 * i / (kCurveSteps - 1);
      const double soft = light < 0.6 ? light : 0.6 + 0.4 * (1 - std::exp(-(light - 0.6) / 0.4));
      const double encoded =
          soft < 0.0031308 ? 12.92 * soft : 1.055 * std::pow(soft, 1 / 2.4) - 0.055;
      made[static_cast<size_t>(i)] =
          static_cast<std::uint8_t>(std::lround(255 * std::clamp(encoded, 0.0, 1.0)));
    }
    return made;
  }();
  return curve;
}

/// Normal deviates to draw from by index: quicker than making each anew.
const std::vector<float>& NormalDeviates() {
  static const std::vector<float> deviates = [] {
    Random random(20, 0x401);
    std::vector<float> made(1 << 16);
    for (float& deviate : made) deviate = static_cast<float>(random.Normal());
    return made;
  }();
  return deviates;
}

}  // namespace

void ImageSensorOptions::Validate() const {
  Require(exposure >= 0 && exposure < 0.1, ErrorCode::kUsage, "the exposure must be 0 to 0.1 s");
  Require(noise >= 0, ErrorCode::kUsage, "the image noise must not be negative");
  Require(jpeg_quality >= 1 && jpeg_quality <= 100, ErrorCode::kUsage,
          "the JPEG quality must be 1 to 100");
}

ImageSensor::ImageSensor(const ImageSensorOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed) {}

double ImageSensor::ExposureRatio() const {
  return options_.exposure > 0 ? options_.exposure / kDaylightExposure : 1;
}

void ImageSensor::FollowLight(const cv::Mat& radiance) {
  constexpr double kTarget = 0.20,
                   kFollow = 0.08;  // mean of linear light; share of the way per frame
  double sum = 0;
  int count = 0;
  for (int row = 2; row < radiance.rows; row += 4) {
    const float* light = radiance.ptr<float>(row);
    for (int column = 2; column < radiance.cols; column += 4) {
      const float green = light[3 * column + 1];
      if (green <= 0) continue;
      sum += std::min(green, 1.0f);
      ++count;
    }
  }
  const double wanted = count > 0 && sum > 0 ? kTarget * count / sum : 1;
  gain_ = gain_ ? *gain_ * std::pow(wanted / *gain_, kFollow) : wanted;
  gain_ = std::min(*gain_, kMostAmplification * kDaylightGain * ExposureRatio());
}

cv::Mat ImageSensor::Develop(const cv::Mat& radiance) {
  FollowLight(radiance);
  const float gain = static_cast<float>(*gain_);
  // Noise of the electrons grows with the amplification, but not with a longer exposure.
  const double amplification = *gain_ / kDaylightGain / ExposureRatio(),
               strength = options_.noise * options_.noise;
  const float shot = static_cast<float>(7e-5 * strength * amplification),
              read = static_cast<float>(1.3e-6 * strength * amplification * amplification);
  const auto& curve = ToneCurve();
  const auto& deviates = NormalDeviates();
  const std::uint64_t frame_seed = Mix64(seed_ ^ Mix64(++num_frames_));
  cv::Mat image(radiance.rows, radiance.cols, CV_8UC3);
  ParallelFor(static_cast<size_t>(radiance.rows), [&](size_t row) {
    const float* light = radiance.ptr<float>(static_cast<int>(row));
    std::uint8_t* out = image.ptr<std::uint8_t>(static_cast<int>(row));
    Random random(frame_seed, row);
    for (int column = 0; column < radiance.cols; ++column) {
      const std::uint64_t bits = random.Bits();
      for (int channel = 0; channel < 3; ++channel) {
        const float exposed = gain * light[3 * column + channel];
        const float noisy =
            exposed + std::sqrt(shot * exposed + read) * deviates[bits >> (16 * channel) & 0xffffu];
        const int step = static_cast<int>(noisy * ((kCurveSteps - 1) / 1.6f) + 0.5f);
        out[3 * column + 2 - channel] =
            curve[static_cast<size_t>(std::clamp(step, 0, kCurveSteps - 1))];
      }
    }
  });
  return image;
}

std::vector<std::uint8_t> EncodeJpeg(const cv::Mat& image, int quality) {
  std::vector<std::uint8_t> jpeg;
  Require(cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality}),
          ErrorCode::kInternal, "an image could not be encoded");
  return jpeg;
}

std::vector<std::uint8_t> EncodePng(const cv::Mat& image) {
  std::vector<std::uint8_t> png;
  Require(cv::imencode(".png", image, png), ErrorCode::kInternal, "a mask could not be encoded");
  return png;
}

}  // namespace parkade::simulator

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "server/ingest/messages/image_decoding.h"
#include "tests/server/ingest/messages/test_images.h"

namespace parkade {
namespace {

using Bytes = std::vector<std::uint8_t>;

ImageMessage MessageOf(const cv::Mat& image, const std::string& encoding) {
  ImageMessage message;
  message.width = static_cast<std::uint32_t>(image.cols);
  message.height = static_cast<std::uint32_t>(image.rows);
  message.step = static_cast<std::uint32_t>(image.step[0]);
  message.encoding = encoding;
  message.data = {image.data, image.step[0] * static_cast<std::size_t>(image.rows)};
  return message;
}

TEST(RawImages, ColorLayoutsGiveTheSameImage) {
  const cv::Mat bgr = Scene(1);
  cv::Mat rgb, rgba, bgra, gray;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  cv::cvtColor(bgr, rgba, cv::COLOR_BGR2RGBA);
  cv::cvtColor(bgr, bgra, cv::COLOR_BGR2BGRA);
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  const std::pair<cv::Mat, std::string> layouts[] = {
      {bgr, "bgr8"}, {rgb, "rgb8"}, {rgba, "rgba8"}, {bgra, "bgra8"}};
  for (const auto& [image, encoding] : layouts) {
    EXPECT_EQ(MaxDifference(DecodeRaw(MessageOf(image, encoding), kColor).image, bgr), 0)
        << encoding;
    EXPECT_LE(MaxDifference(DecodeRaw(MessageOf(image, encoding), kGray).image, gray), 1)
        << encoding;
  }
  EXPECT_EQ(MaxDifference(DecodeRaw(MessageOf(gray, "mono8"), kColor).image, gray), 0);
}

/// The luma and chroma of an image, which takes its colors from 2x2 pixels.
cv::Mat PlanarYuv(const cv::Mat& bgr) {
  cv::Mat planar;
  cv::cvtColor(bgr, planar, cv::COLOR_BGR2YUV_I420);
  return planar;
}

TEST(RawImages, LumaAndChromaGiveTheImageBack) {
  const cv::Mat bgr(40, 64, CV_8UC3, cv::Scalar(200, 120, 40));
  const cv::Mat planar = PlanarYuv(bgr);  // 40 rows of luma, 10 of u, 10 of v
  const std::uint8_t y = planar.at<std::uint8_t>(0, 0), u = planar.at<std::uint8_t>(45, 0),
                     v = planar.at<std::uint8_t>(55, 0);
  const auto packed = [](std::uint8_t first, std::uint8_t second, std::uint8_t third) {
    cv::Mat image(40, 64, CV_8UC2);
    for (int row = 0; row < image.rows; ++row)
      for (int x = 0; x < image.cols; ++x)
        image.at<cv::Vec2b>(row, x) = first == third ? cv::Vec2b(first, second) : cv::Vec2b();
    return image;
  };
  cv::Mat yuyv = packed(y, u, y), uyvy = packed(u, y, u);
  for (int row = 0; row < 40; ++row)
    for (int x = 1; x < 64; x += 2) {
      yuyv.at<cv::Vec2b>(row, x)[1] = v;
      uyvy.at<cv::Vec2b>(row, x)[0] = v;
    }
  cv::Mat nv12(60, 64, CV_8UC1, cv::Scalar(y)), nv21 = nv12.clone();
  for (int row = 40; row < 60; ++row)
    for (int x = 0; x < 64; ++x) {
      nv12.at<std::uint8_t>(row, x) = x % 2 == 0 ? u : v;
      nv21.at<std::uint8_t>(row, x) = x % 2 == 0 ? v : u;
    }
  const std::pair<cv::Mat, std::string> layouts[] = {{yuyv, "yuv422_yuy2"}, {yuyv, "YUYV"},
                                                     {uyvy, "yuv422"},      {uyvy, "UYVY"},
                                                     {nv12, "nv12"},        {nv21, "NV21"}};
  for (const auto& [image, encoding] : layouts) {
    ImageMessage message = MessageOf(image, encoding);
    message.height = 40;
    EXPECT_LE(MaxDifference(DecodeRaw(message, kColor).image, bgr), 4) << encoding;
    EXPECT_LE(
        MaxDifference(DecodeRaw(message, kGray).image, cv::Mat(40, 64, CV_8UC1, cv::Scalar(y))), 0)
        << encoding;
    message.data = message.data.first(message.data.size() / 2);
    EXPECT_EQ(DecodeRaw(message, kColor).fault, ImageFault::kDamaged) << encoding;
  }
}

TEST(RawImages, EncodingsAreSpelledAnyhowAndAStepMayBeMissing) {
  const cv::Mat bgr = Scene(3);
  cv::Mat bgra;
  cv::cvtColor(bgr, bgra, cv::COLOR_BGR2BGRA);
  EXPECT_EQ(MaxDifference(DecodeRaw(MessageOf(bgr, "BGR8"), kColor).image, bgr), 0);
  EXPECT_EQ(MaxDifference(DecodeRaw(MessageOf(bgra, "8UC4"), kColor).image, bgr), 0);
  ImageMessage message = MessageOf(bgr, "bgr8");
  message.step = 0;
  EXPECT_EQ(MaxDifference(DecodeRaw(message, kColor).image, bgr), 0);
}

/// Packs samples as a string of bits, the lowest first: bit by bit, unlike the reader.
Bytes Packed(const std::vector<unsigned>& samples, int bits) {
  Bytes packed((samples.size() * static_cast<std::size_t>(bits) + 7) / 8, 0);
  std::size_t at = 0;
  for (const unsigned sample : samples)
    for (int bit = 0; bit < bits; ++bit, ++at)
      packed[at / 8] = static_cast<std::uint8_t>(packed[at / 8] | (sample >> bit & 1) << at % 8);
  return packed;
}

TEST(RawImages, PackedSamplesGiveTheirUpperEightBits) {
  for (const int bits : {10, 12})
    for (const std::uint32_t width : {1U, 5U, 8U}) {
      ImageMessage message;
      message.width = width;
      message.height = 3;
      message.encoding = "Mono" + std::to_string(bits) + "p";
      Bytes rows;
      std::vector<unsigned> all;
      for (unsigned y = 0; y < message.height; ++y) {
        std::vector<unsigned> samples;
        for (unsigned x = 0; x < width; ++x)
          samples.push_back((397 * (y * width + x + 1)) % (1U << bits));
        all.insert(all.end(), samples.begin(), samples.end());
        const Bytes row = Packed(samples, bits);
        rows.insert(rows.end(), row.begin(), row.end());
      }
      message.data = rows;

      const DecodedImage decoded = DecodeRaw(message, kGray);

      ASSERT_EQ(decoded.fault, ImageFault::kNone) << decoded.what;
      for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ(decoded.image.data[i], all[i] >> (bits - 8));
      message.data = message.data.first(rows.size() - 1);
      EXPECT_EQ(DecodeRaw(message, kGray).fault, ImageFault::kDamaged);
    }
}

TEST(RawImages, SamplesOfTwelveBitsMayStandInSixteen) {
  ImageMessage message;
  message.width = 2;
  message.height = 1;
  message.encoding = "bayer_rggb12";
  const Bytes data = {0xf0, 0x0f, 0x00, 0x01};  // 4080 and 256
  message.data = data;

  ImageRequest request = kGray;
  request.sample_bits = 12;
  EXPECT_EQ(DecodeRaw(message, request).image.size(), cv::Size(2, 1));
  message.encoding = "mono12";
  const DecodedImage decoded = DecodeRaw(message, request);
  EXPECT_EQ(decoded.image.at<std::uint8_t>(0, 0), 255);
  EXPECT_EQ(decoded.image.at<std::uint8_t>(0, 1), 16);
}

TEST(RawImages, EachBayerPatternGivesBackItsColors) {
  const cv::Mat bgr(16, 16, CV_8UC3, cv::Scalar(200, 120, 40));  // blue, green, red
  const std::pair<std::string, std::string> patterns[] = {{"bayer_rggb8", "rggb"},
                                                          {"bayer_bggr8", "bggr"},
                                                          {"bayer_gbrg8", "gbrg"},
                                                          {"bayer_grbg8", "grbg"}};
  for (const auto& [encoding, pattern] : patterns) {
    cv::Mat mosaic(16, 16, CV_8UC1);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const char color = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
        mosaic.at<std::uint8_t>(y, x) = color == 'b' ? 200 : color == 'g' ? 120 : 40;
      }

    EXPECT_LE(MaxDifference(DecodeRaw(MessageOf(mosaic, encoding), kColor).image, bgr), 1)
        << encoding;
  }
}

TEST(RawImages, SixteenBitsAreNarrowedByTheBitsInUse) {
  cv::Mat deep(4, 4, CV_16UC1);
  for (int i = 0; i < 16; ++i)
    deep.at<std::uint16_t>(i / 4, i % 4) = static_cast<std::uint16_t>(i * 273);  // 12 bits
  SensorStream stream;
  stream.type = "sensor_msgs/Image";

  const cv::Mat twelve = DecodeRaw(MessageOf(deep, "mono16"), {.sample_bits = 12}).image;
  const cv::Mat sixteen = DecodeRaw(MessageOf(deep, "mono16"), {.sample_bits = 16}).image;

  EXPECT_EQ(twelve.at<std::uint8_t>(3, 3), 255);
  EXPECT_EQ(twelve.at<std::uint8_t>(0, 1), 273 >> 4);
  EXPECT_EQ(sixteen.at<std::uint8_t>(3, 3), 15);
  ImageMessage swapped = MessageOf(deep, "mono16");
  swapped.is_bigendian = true;
  EXPECT_EQ(DecodeRaw(swapped, {.sample_bits = 16}).image.at<std::uint8_t>(0, 1), 273 & 0xff);
}

TEST(RawImages, PaddedRowsAreCutAndShortOnesRefused) {
  const cv::Mat wide = Scene(2, 80, 40);
  cv::Mat gray;
  cv::cvtColor(wide, gray, cv::COLOR_BGR2GRAY);
  const cv::Mat left = gray.colRange(0, 64);  // step 80
  EXPECT_EQ(MaxDifference(DecodeRaw(MessageOf(left, "mono8"), kGray).image, left), 0);

  ImageMessage message = MessageOf(gray, "mono8");
  message.data = message.data.first(message.data.size() - 1);
  EXPECT_EQ(DecodeRaw(message, kGray).fault, ImageFault::kDamaged);
  message = MessageOf(gray, "mono8");
  message.step = 79;
  EXPECT_EQ(DecodeRaw(message, kGray).fault, ImageFault::kDamaged);
  message = MessageOf(gray, "mono8");
  message.width = message.height = 0xffffffff;
  EXPECT_EQ(DecodeRaw(message, kGray).fault, ImageFault::kDamaged);
  EXPECT_EQ(DecodeRaw(MessageOf(gray, "yuv9"), kGray).fault, ImageFault::kDamaged);
}

TEST(RawImages, SizesThatOverflowAreDamaged) {
  const cv::Mat gray(4, 4, CV_8UC1, cv::Scalar(7));
  ImageMessage message = MessageOf(gray, "mono12p");
  message.step = 0;
  message.width = 2'863'355'221;  // rows of 12 bits, times the height: 2^64 + 65536 bytes
  message.height = 4'294'901'761;
  const std::vector<std::uint8_t> bytes(65'536);
  message.data = bytes;
  EXPECT_EQ(DecodeRaw(message, kGray).fault, ImageFault::kDamaged);

  message = MessageOf(gray, "mono16");
  message.step = 0;
  message.width = 0x80000002;  // two bytes each: 4
  EXPECT_EQ(DecodeRaw(message, kGray).fault, ImageFault::kDamaged);
}

TEST(RawImages, AMessageThatEndsTooEarlyIsDamagedAndHasNoBits) {
  SensorStream stream;
  stream.type = "sensor_msgs/Image";
  for (const MessageEncoding encoding : {MessageEncoding::kCdr, MessageEncoding::kRos1}) {
    stream.encoding = encoding;
    RawMessage message;
    message.data = {0, 1, 0, 0, 9, 9, 9};
    EXPECT_EQ(DecodeMessageImage(message, stream, kGray).fault, ImageFault::kDamaged);
    EXPECT_EQ(SampleBits(message, stream), std::nullopt);
  }
}

}  // namespace
}  // namespace parkade

#include "server/ingest/video/video_decoder.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/server/ingest/video/video_log.h"

namespace parkade {
namespace {

constexpr double kLossOfCodec = 3;  // [gray levels] of any image here

/// The packets of a video by either encoder.
class VideoDecoding : public testing::TestWithParam<const char*> {
 protected:
  std::vector<VideoPacket> Packets(const std::vector<cv::Mat>& images,
                                   VideoWriterOptions options = {}) const {
    options.encoder = GetParam();
    std::vector<VideoPacket> packets;
    for (const std::vector<std::uint8_t>& data : EncodeVideo(images, options))
      packets.push_back(PacketOf(data));
    return packets;
  }

  static VideoPacket PacketOf(const std::vector<std::uint8_t>& data) {
    return AsVideoPacket(GetParam(), data).value();
  }

  static std::vector<ImageFault> FaultsOf(const std::vector<VideoPacket>& packets,
                                          const ImageRequest& request = {}) {
    VideoDecoder decoder;
    std::vector<ImageFault> faults;
    for (const VideoPacket& packet : packets)
      faults.push_back(decoder.Decode(packet, request).fault);
    return faults;
  }
};

std::vector<ImageFault> Faults(std::initializer_list<std::pair<int, ImageFault>> runs) {
  std::vector<ImageFault> faults;
  for (const auto& [count, fault] : runs)
    faults.insert(faults.end(), static_cast<std::size_t>(count), fault);
  return faults;
}

TEST_P(VideoDecoding, EveryPacketIsItsImageInEitherRangeOfGrayLevels) {
  const std::vector<cv::Mat> images = MovingDisks(25);
  for (const bool is_full_range : {false, true}) {
    const auto packets = Packets(images, {.is_full_range = is_full_range});
    VideoDecoder decoder, color_decoder;
    for (std::size_t i = 0; i < packets.size(); ++i) {
      const DecodedImage gray = decoder.Decode(packets[i], {}),
                         color = color_decoder.Decode(packets[i], {.grayscale = false});
      ASSERT_EQ(gray.fault, ImageFault::kNone) << gray.what;
      ASSERT_EQ(color.image.type(), CV_8UC3);
      cv::Mat blue;
      cv::extractChannel(color.image, blue, 0);
      EXPECT_LT(Difference(gray.image, images[i]), kLossOfCodec);
      EXPECT_LT(Difference(blue, images[i]), kLossOfCodec);
      EXPECT_EQ(packets[i].is_key_frame, i % 10 == 0);
    }
  }
}

TEST_P(VideoDecoding, ImagesBeforeTheFirstKeyFrameWaitForIt) {
  auto packets = Packets(MovingDisks(25));
  packets.erase(packets.begin(), packets.begin() + 6);

  EXPECT_EQ(FaultsOf(packets),
            Faults({{4, ImageFault::kWaitsForKeyFrame}, {15, ImageFault::kNone}}));
}

TEST_P(VideoDecoding, BehindALostPacketAllIsDamagedUpToTheNextKeyFrame) {
  auto packets = Packets(MovingDisks(25));
  packets.erase(packets.begin() + 13);

  EXPECT_EQ(FaultsOf(packets),
            Faults({{13, ImageFault::kNone}, {6, ImageFault::kDamaged}, {5, ImageFault::kNone}}));
}

TEST_P(VideoDecoding, BehindAPacketThatIsNoneAllIsDamagedUpToTheNextKeyFrame) {
  auto packets = Packets(MovingDisks(25));
  packets[13].data.resize(12);

  EXPECT_EQ(FaultsOf(packets),
            Faults({{13, ImageFault::kNone}, {7, ImageFault::kDamaged}, {5, ImageFault::kNone}}));
}

TEST_P(VideoDecoding, ParametersThatCameOnceServeAllKeyFrames) {
  const std::vector<cv::Mat> images = MovingDisks(25);
  const auto packets = Packets(images, {.repeats_parameters = false});
  ASSERT_FALSE(packets[0].parameter_sets.empty());
  ASSERT_TRUE(packets[20].parameter_sets.empty());
  VideoDecoder decoder;

  decoder.Note(packets[0]);
  const DecodedImage decoded = decoder.Decode(packets[20], {});

  ASSERT_EQ(decoded.fault, ImageFault::kNone) << decoded.what;
  EXPECT_LT(Difference(decoded.image, images[20]), kLossOfCodec);
  EXPECT_EQ(FaultsOf({packets[20]}), Faults({{1, ImageFault::kWaitsForKeyFrame}}));
}

TEST_P(VideoDecoding, TheSizeMayChangeAndIsCheckedAgainstTheRig) {
  std::vector<cv::Mat> small = MovingDisks(5);
  for (cv::Mat& image : small) image = image(cv::Rect(0, 0, 96, 64)).clone();
  auto packets = Packets(MovingDisks(5));
  for (const VideoPacket& packet : Packets(small)) packets.push_back(packet);

  EXPECT_EQ(FaultsOf(packets), Faults({{10, ImageFault::kNone}}));
  EXPECT_EQ(FaultsOf(packets, {.width = kVideoWidth, .height = kVideoHeight}),
            Faults({{5, ImageFault::kNone}, {5, ImageFault::kWrongSize}}));
}

TEST_P(VideoDecoding, AVideoThatHoldsImagesBackIsRefusedInOneSentence) {
  const auto packets = Packets(MovingDisks(25), {.num_b_frames = 2});
  VideoDecoder decoder;

  for (const VideoPacket& packet : packets)
    EXPECT_NE(decoder.Decode(packet, {}).what.find("record it without B-frames"),
              std::string::npos);
}

TEST_P(VideoDecoding, DamagedBytesNeverCrashNorStopLaterImages) {
  const auto packets = Packets(MovingDisks(30));
  std::mt19937 random(4);  // fixed seed: the same damage everywhere
  VideoDecoder decoder;
  for (int trial = 0; trial < 60; ++trial) {
    for (std::size_t i = 0; i < 10; ++i) {
      VideoPacket packet = packets[i];
      for (int flips = 0; flips < 4; ++flips)
        packet.data[random() % packet.data.size()] ^= static_cast<std::uint8_t>(random());
      if (random() % 4 == 0) packet.data.resize(random() % packet.data.size());
      decoder.Decode(PacketOf(packet.data), {});
    }
    EXPECT_EQ(decoder.Decode(packets[20], {}).fault, ImageFault::kNone);
  }
}

INSTANTIATE_TEST_SUITE_P(Codecs, VideoDecoding, testing::Values("libx264", "libx265"));

TEST(VideoPacket, TheCodecIsToldByTheFormatOrByTheBytes) {
  const auto h264 = EncodeVideo(MovingDisks(3)),
             h265 = EncodeVideo(MovingDisks(3), WithEncoder("libx265"));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(AsVideoPacket("", h264[i]).value().codec, VideoCodec::kH264);
    EXPECT_EQ(AsVideoPacket("video", h265[i]).value().codec, VideoCodec::kH265);
  }
  const std::vector<std::uint8_t> text = {'t', 'e', 'x', 't', ' ', 'o', 'n', 'l', 'y'};
  EXPECT_FALSE(AsVideoPacket("jpeg", text).has_value());
}

TEST(VideoPacket, ACodecThatIsNotDecodedIsNamed) {
  const std::vector<std::uint8_t> data(20, 7);
  VideoDecoder decoder;

  EXPECT_EQ(decoder.Decode(AsVideoPacket("vp9", data).value(), {}).what,
            "'vp9' video: it is not decoded: record H.264, H.265 or JPEG");
  EXPECT_EQ(decoder.Decode(AsVideoPacket("h264", data).value(), {}).what,
            "H.264 video: the message holds no image in Annex B form (with start codes)");
}

}  // namespace
}  // namespace parkade

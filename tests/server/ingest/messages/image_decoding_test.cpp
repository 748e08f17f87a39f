#include "server/ingest/messages/image_decoding.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/server/ingest/drive/euroc_folder.h"

namespace parkade {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Smooth shapes with texture and noise, as a codec meets them.
cv::Mat Scene(int seed, int width = 320, int height = 240) {
  cv::Mat image(height, width, CV_8UC3, cv::Scalar(180, 160, 140));
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  for (int i = 0; i < 40; ++i) {
    const cv::Point center(random.uniform(0, width), random.uniform(0, height));
    const cv::Scalar color(random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255));
    cv::circle(image, center, random.uniform(5, 50), color, -1);
  }
  cv::GaussianBlur(image, image, {3, 3}, 0);
  cv::Mat noise(image.size(), CV_8UC3);
  random.fill(noise, cv::RNG::NORMAL, 8, 4);
  image += noise;
  return image;
}

Bytes Encode(const cv::Mat& image, const std::string& extension,
             const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(extension, image, bytes, parameters);
  return bytes;
}

ImageMessage MessageOf(const cv::Mat& image, const std::string& encoding) {
  ImageMessage message;
  message.width = static_cast<std::uint32_t>(image.cols);
  message.height = static_cast<std::uint32_t>(image.rows);
  message.step = static_cast<std::uint32_t>(image.step[0]);
  message.encoding = encoding;
  message.data = {image.data, image.step[0] * static_cast<std::size_t>(image.rows)};
  return message;
}

const ImageRequest kGray{}, kColor{.grayscale = false};

double MaxDifference(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return 1e9;
  return cv::norm(a, b, cv::NORM_INF);
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

TEST(CompressedImages, ANameThatNoFileCanHaveIsDamaged) {
  SensorStream stream;
  stream.encoding = MessageEncoding::kEuroc;
  RawMessage message;
  message.data.assign(5000, 'a');
  EXPECT_EQ(DecodeMessageImage(message, stream, kGray).fault, ImageFault::kDamaged);
}

TEST(CompressedImages, JpegAndPngDecodeAsOpenCvDecodesThem) {
  const cv::Mat scene = Scene(3);
  for (const std::string extension : {".jpg", ".png"}) {
    const Bytes bytes = Encode(scene, extension);

    EXPECT_EQ(
        MaxDifference(DecodeCompressed(bytes, kColor).image, cv::imdecode(bytes, cv::IMREAD_COLOR)),
        0);
    EXPECT_LE(MaxDifference(DecodeCompressed(bytes, kGray).image,
                            cv::imdecode(bytes, cv::IMREAD_GRAYSCALE)),
              1);
  }
  cv::Mat gray;
  cv::cvtColor(scene, gray, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(DecodeCompressed(Encode(gray, ".jpg"), kColor).image.type(), CV_8UC1);
}

TEST(CompressedImages, AnotherSizeThanCalibratedIsSaid) {
  const ImageRequest request{.width = 640, .height = 240};
  for (const std::string extension : {".jpg", ".png"}) {
    const DecodedImage decoded = DecodeCompressed(Encode(Scene(3), extension), request);

    EXPECT_EQ(decoded.fault, ImageFault::kWrongSize);
    EXPECT_EQ(decoded.what, "the image is 320x240, calibrated is 640x240");
  }
}

TEST(CompressedImages, AFloodOfPixelsIsRefusedByItsHeader) {
  const Bytes png = Encode(cv::Mat::zeros(20000, 10000, CV_8UC1), ".png");
  ASSERT_LT(png.size(), 1u << 20);

  EXPECT_EQ(DecodeCompressed(png, kGray).fault, ImageFault::kWrongSize);
}

TEST(CompressedImages, WhatIsNoImageIsDamaged) {
  for (const std::string text :
       {"", "x", "GIF89a", "\xff\xd8", "\xff\xd8\xff\xd9", "\x89PNG\r\n\x1a\n"}) {
    const Bytes bytes(text.begin(), text.end());
    EXPECT_EQ(DecodeCompressed(bytes, kGray).fault, ImageFault::kDamaged) << text;
  }
}

TEST(CompressedImages, EveryJpegSettingPassesTheDamageCheck) {
  int count = 0;
  for (int seed = 0; seed < 12; ++seed) {
    for (const int quality : {10, 30, 50, 75, 90, 95, 100}) {
      for (const int variant : {0, 1, 2, 3}) {
        std::vector<int> parameters = {cv::IMWRITE_JPEG_QUALITY, quality};
        if (variant == 1) parameters.insert(parameters.end(), {cv::IMWRITE_JPEG_OPTIMIZE, 1});
        if (variant == 2)
          parameters.insert(parameters.end(), {cv::IMWRITE_JPEG_RST_INTERVAL, 1 + seed});
        if (variant == 3) parameters.insert(parameters.end(), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
        cv::Mat scene = Scene(seed, 317, 201 + seed);
        if (seed % 3 == 0)
          cv::threshold(scene, scene, 128, 255, cv::THRESH_BINARY);  // the largest coefficients
        if (seed % 2 == 0) cv::cvtColor(scene, scene, cv::COLOR_BGR2GRAY);

        const DecodedImage decoded = DecodeCompressed(Encode(scene, ".jpg", parameters), kGray);

        EXPECT_EQ(decoded.fault, ImageFault::kNone)
            << seed << " " << quality << " " << variant << " " << decoded.what;
        ++count;
      }
    }
  }
  EXPECT_EQ(count, 336);
}

/// Visibly wrong: more than 64 pixels are off by more than 16 gray levels, or there is no image.
bool IsVisiblyWrong(const Bytes& mutant, const cv::Mat& original) {
  const cv::Mat decoded = cv::imdecode(mutant, cv::IMREAD_GRAYSCALE);
  if (decoded.size() != original.size()) return true;
  cv::Mat difference;
  cv::absdiff(decoded, original, difference);
  return cv::countNonZero(difference > 16) > 64;
}

TEST(CompressedImages, DamagedJpegsAreNoticed) {
  std::mt19937 random(11);
  int num_visible = 0, num_noticed = 0, num_cut = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Bytes whole =
        Encode(Scene(trial % 20), ".jpg", {cv::IMWRITE_JPEG_QUALITY, 80 + trial % 16});
    const cv::Mat original = cv::imdecode(whole, cv::IMREAD_GRAYSCALE);
    Bytes mutant = whole;
    if (trial % 4 == 0) {
      mutant.resize(1 + random() % (whole.size() - 3));
      EXPECT_EQ(DecodeCompressed(mutant, kGray).fault, ImageFault::kDamaged)
          << "cut at " << mutant.size();
      ++num_cut;
      continue;
    }
    const std::size_t num_flips = trial % 4 == 1 ? 1 : 10;
    for (std::size_t i = 0; i < num_flips; ++i)
      mutant[700 + random() % (whole.size() - 700)] ^= static_cast<std::uint8_t>(1 << random() % 8);
    if (!IsVisiblyWrong(mutant, original)) continue;
    ++num_visible;
    if (DecodeCompressed(mutant, kGray).fault != ImageFault::kNone) ++num_noticed;
  }
  EXPECT_EQ(num_cut, 100);
  EXPECT_GT(num_visible, 200);
  // The rest are single bits that turned one possible coefficient into another.
  EXPECT_GE(num_noticed, 0.96 * num_visible) << num_noticed << " of " << num_visible;
  RecordProperty("visible", num_visible);
  RecordProperty("noticed", num_noticed);
}

/// Where the coded data begin, and where a marker follows them: that of a restart or EOI.
std::vector<std::size_t> EdgesOfScan(const Bytes& jpeg) {
  std::size_t at = 2;
  while (jpeg[at + 1] != 0xda) at += 2 + static_cast<std::size_t>(jpeg[at + 2] << 8 | jpeg[at + 3]);
  std::vector<std::size_t> edges = {at + 2 +
                                    static_cast<std::size_t>(jpeg[at + 2] << 8 | jpeg[at + 3])};
  for (at = edges.front(); at + 1 < jpeg.size(); ++at)
    if (jpeg[at] == 0xff && jpeg[at + 1] != 0) edges.push_back(at);
  return edges;
}

/// The file with `stuffing` before each marker that follows coded data.
Bytes Stuffed(Bytes jpeg, const Bytes& stuffing) {
  const std::vector<std::size_t> edges = EdgesOfScan(jpeg);
  for (std::size_t i = edges.size() - 1; i > 0; --i)
    jpeg.insert(jpeg.begin() + static_cast<std::ptrdiff_t>(edges[i]), stuffing.begin(),
                stuffing.end());
  return jpeg;
}

/// The file without its Huffman tables, as cameras send motion JPEG.
Bytes WithoutHuffmanTables(Bytes jpeg) {
  for (std::size_t at = 2; jpeg[at + 1] != 0xda;) {
    const auto begin = jpeg.begin() + static_cast<std::ptrdiff_t>(at);
    const int size = 2 + (jpeg[at + 2] << 8 | jpeg[at + 3]);
    if (jpeg[at + 1] == 0xc4)
      jpeg.erase(begin, begin + size);
    else
      at += static_cast<std::size_t>(size);
  }
  return jpeg;
}

/// The files of one scene: plain, with restart markers, and each without Huffman tables.
std::vector<Bytes> WebcamJpegs(int seed) {
  std::vector<Bytes> files;
  for (const int interval : {0, 1, 7}) {
    files.push_back(Encode(Scene(seed), ".jpg", {cv::IMWRITE_JPEG_RST_INTERVAL, interval}));
    files.push_back(WithoutHuffmanTables(files.back()));
  }
  return files;
}

TEST(CompressedImages, ZerosBeforeAMarkerAreNoDamage) {
  for (int seed = 0; seed < 5; ++seed)
    for (const Bytes& whole : WebcamJpegs(seed)) {
      const cv::Mat image = DecodeCompressed(whole, kColor).image;
      ASSERT_FALSE(image.empty());
      for (const std::size_t count : {1, 2, 3, 4, 7, 8, 9, 500}) {
        const DecodedImage decoded = DecodeCompressed(Stuffed(whole, Bytes(count, 0)), kColor);

        EXPECT_EQ(decoded.fault, ImageFault::kNone) << count << " " << decoded.what;
        EXPECT_EQ(MaxDifference(decoded.image, image), 0) << count;
      }
    }
}

TEST(CompressedImages, OtherBytesBeforeAMarkerAreDamage) {
  for (const Bytes& whole : WebcamJpegs(6))
    for (const Bytes& stuffing : {Bytes{0, 0, 1}, Bytes{1, 0, 0}, Bytes(40, 0x55), Bytes{0xff, 0}})
      EXPECT_EQ(DecodeCompressed(Stuffed(whole, stuffing), kColor).fault, ImageFault::kDamaged);
  const Bytes progressive = Encode(Scene(6), ".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  EXPECT_EQ(DecodeCompressed(Stuffed(progressive, Bytes(40, 0x55)), kColor).fault,
            ImageFault::kDamaged);
}

TEST(CompressedImages, NoDamageThatTheCodecForgivesIsLookedForInAnIntactImage) {
  const ImageRequest intact{.is_intact = true};
  const Bytes whole = Encode(Scene(6), ".jpg"), stuffed = Stuffed(whole, {0, 0, 1});
  const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() / 2));

  EXPECT_EQ(
      MaxDifference(DecodeCompressed(stuffed, intact).image, DecodeCompressed(whole, kGray).image),
      0);
  EXPECT_EQ(DecodeCompressed(cut, intact).fault, ImageFault::kDamaged);
}

TEST(CompressedImages, CodedDataThatTurnToZerosAreDamage) {
  for (const Bytes& whole : WebcamJpegs(7)) {
    const std::vector<std::size_t> edges = EdgesOfScan(whole);
    for (const int eighth : {1, 4, 6, 7}) {
      Bytes mutant = whole;
      const auto begin =
          edges.front() + (edges.back() - edges.front()) * static_cast<std::size_t>(eighth) / 8;
      std::fill(mutant.begin() + static_cast<std::ptrdiff_t>(begin), mutant.end() - 2,
                std::uint8_t{0});

      EXPECT_EQ(DecodeCompressed(mutant, kColor).fault, ImageFault::kDamaged) << eighth;
    }
  }
}

TEST(CompressedImages, DamagedPngsAreNoticed) {
  std::mt19937 random(12);
  const Bytes whole = Encode(Scene(1, 160, 120), ".png");
  for (int trial = 0; trial < 200; ++trial) {
    Bytes mutant = whole;
    mutant[random() % mutant.size()] ^= static_cast<std::uint8_t>(1 << random() % 8);
    if (trial % 4 == 0) mutant.resize(random() % mutant.size());

    EXPECT_NE(DecodeCompressed(mutant, kGray).fault, ImageFault::kNone);
  }
}

TEST(CompressedImages, RealFramesRaiseNoFalseAlarm) {
  const std::filesystem::path folders[] = {SharedData() / "camvid/val/images",
                                           SharedData() / "euroc_v101_moving/mav0/cam0/data",
                                           SharedData() / "euroc_v101_clip/mav0/cam0/data"};
  int count = 0;
  for (const auto& folder : folders) {
    if (!std::filesystem::exists(folder))
      GTEST_SKIP() << "PARKADE_SHARED_DATA has no " << folder.filename();
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      std::ifstream stream(file.path(), std::ios::binary);
      const Bytes bytes{std::istreambuf_iterator<char>(stream), {}};
      const DecodedImage decoded = DecodeCompressed(bytes, kGray);
      EXPECT_EQ(decoded.fault, ImageFault::kNone) << file.path().filename() << " " << decoded.what;
      ++count;
    }
  }
  EXPECT_GT(count, 250);
}

}  // namespace
}  // namespace parkade

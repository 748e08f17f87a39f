#include "server/ingest/messages/image_decoding.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/server/ingest/drive/euroc_folder.h"
#include "tests/server/ingest/messages/test_images.h"

namespace parkade {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes Encode(const cv::Mat& image, const std::string& extension,
             const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(extension, image, bytes, parameters);
  return bytes;
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

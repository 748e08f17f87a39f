#include "server/ingest/pictures/picture_index.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "server/ingest/pictures/read_picture.h"
#include "tests/server/ingest/messages/message_writer.h"

namespace parkade {
namespace {

constexpr std::int64_t kBegin = 1'700'000'000'000'000'000, kMs = 1'000'000;
constexpr int kWidth = 64, kHeight = 48;

Rig TwoCameras() {
  Rig rig;
  rig.imu.topic = "/imu";
  for (const char* name : {"cam0", "cam1"}) {
    RigCamera& camera = rig.cameras.emplace_back();
    camera.name = name;
    camera.topic = std::string("/") + name + "/image_raw";
    camera.model = CameraModel(PinholeProjection{30, 30, 32, 24}, kWidth, kHeight);
  }
  rig.cameras[1].time_shift = 0.004;
  return rig;
}

/// An image of one gray value: ten times its number.
void AddImage(MemorySource& log, int camera, int number, std::int64_t stamp, size_t bytes) {
  ImageValues image{kWidth, kHeight, kWidth, "mono8", false, std::vector<std::uint8_t>(bytes)};
  std::fill(image.data.begin(), image.data.end(), static_cast<std::uint8_t>(10 * number));
  log.Add("/cam" + std::to_string(camera) + "/image_raw", "sensor_msgs/Image", stamp,
          ImageBytes(log.Writer(), stamp, "camera", image));
}

/// Two seconds; an image of cam0 each 0.1 s, of cam1 0.05 s later. The one of cam0 at 1 s is cut
/// off, and one of cam0 has the stamp of another clock.
MemorySource TwoSeconds() {
  MemorySource log;
  for (int ms = 0; ms <= 2000; ms += 5) {
    const std::int64_t now = kBegin + ms * kMs;
    log.Add("/imu", "sensor_msgs/Imu", now, ImuBytes(log.Writer(), now, "imu"));
    if (ms % 100 == 0) AddImage(log, 0, ms / 100, now, ms == 1000 ? 100 : kWidth * kHeight);
    if (ms % 100 == 50) AddImage(log, 1, ms / 100, now, kWidth * kHeight);
    if (ms == 700) AddImage(log, 0, 0, now + 500'000 * kMs, kWidth * kHeight);
  }
  return log;
}

TEST(PictureIndex, HoldsEveryImageOnTheImusClock) {
  const MemorySource log = TwoSeconds();
  const PictureIndex index = IndexPictures(log, TwoCameras());

  ASSERT_EQ(index.cameras.size(), 2u);
  ASSERT_EQ(index.cameras[0].images.size(), 21u);
  ASSERT_EQ(index.cameras[1].images.size(), 20u);
  for (size_t i = 0; i < 21; ++i)
    EXPECT_EQ(index.cameras[0].images[i].time.ns, kBegin + static_cast<int>(i) * 100 * kMs);
  EXPECT_EQ(index.cameras[1].images[3].time.ns, kBegin + 354 * kMs) << "its time shift counts";
}

TEST(PictureIndex, ReadsTheSameAsWasWritten) {
  const PictureIndex index = IndexPictures(TwoSeconds(), TwoCameras());
  const PictureIndex read = DecodePictureIndex(EncodePictureIndex(index));

  ASSERT_EQ(read.cameras.size(), 2u);
  for (size_t camera = 0; camera < 2; ++camera) {
    EXPECT_EQ(read.cameras[camera].name, index.cameras[camera].name);
    EXPECT_EQ(read.cameras[camera].stream.topic, index.cameras[camera].stream.topic);
    EXPECT_EQ(read.cameras[camera].stream.type, index.cameras[camera].stream.type);
    EXPECT_EQ(read.cameras[camera].stream.time_shift, index.cameras[camera].stream.time_shift);
    ASSERT_EQ(read.cameras[camera].images.size(), index.cameras[camera].images.size());
    for (size_t i = 0; i < read.cameras[camera].images.size(); ++i) {
      EXPECT_EQ(read.cameras[camera].images[i].time, index.cameras[camera].images[i].time);
      EXPECT_EQ(read.cameras[camera].images[i].place.record,
                index.cameras[camera].images[i].place.record);
    }
  }
}

TEST(PictureIndex, RefusesWhatIsNone) {
  for (const char* text : {"", "{}", R"({"version": 0, "cameras": []})",
                           R"({"version": 1, "cameras": [{"name": "cam0"}]})"})
    EXPECT_THROW(DecodePictureIndex(text), Error) << text;
}

TEST(ReadPicture, GivesTheImageThatTheIndexNames) {
  const MemorySource log = TwoSeconds();
  const PictureIndex index = IndexPictures(log, TwoCameras());
  for (const size_t number : {0u, 7u, 20u}) {
    const Picture picture = ReadPicture(log, index.cameras[0], index.cameras[0].images[number], 0);

    EXPECT_EQ(picture.width, kWidth);
    EXPECT_EQ(picture.height, kHeight);
    const std::vector<char> bytes(picture.jpeg.begin(), picture.jpeg.end());
    const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
    EXPECT_NEAR(cv::mean(decoded)[0], 10.0 * static_cast<double>(number), 2);
  }
}

TEST(ReadPicture, MakesItSmallerButNeverLarger) {
  const MemorySource log = TwoSeconds();
  const PictureIndex index = IndexPictures(log, TwoCameras());
  const IndexedCamera& camera = index.cameras[1];

  const Picture small = ReadPicture(log, camera, camera.images[5], 32);
  EXPECT_EQ(small.width, 32);
  EXPECT_EQ(small.height, 24);
  EXPECT_EQ(small.full_width, kWidth);
  EXPECT_EQ(small.full_height, kHeight);
  EXPECT_EQ(ReadPicture(log, camera, camera.images[5], 640).width, kWidth);
}

TEST(ReadPicture, SaysWhichImageIsDamaged) {
  const MemorySource log = TwoSeconds();
  const PictureIndex index = IndexPictures(log, TwoCameras());
  const auto sentence_of = [&](const IndexedImage& image) -> std::string {
    try {
      ReadPicture(log, index.cameras[0], image, 0);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };

  EXPECT_EQ(sentence_of(index.cameras[0].images[10]),
            "the image of cam0 at 1700000001.000000000 is damaged: the image has fewer bytes than "
            "its size needs");
  EXPECT_EQ(sentence_of({{kBegin}, {1'000'000}}),
            "the image of cam0 at 1700000000.000000000 cannot be read from the log");
}

}  // namespace
}  // namespace parkade

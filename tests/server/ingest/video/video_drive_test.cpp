#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "server/ingest/conversion/convert_log.h"
#include "server/ingest/drive/open_drive_log.h"
#include "server/ingest/pictures/read_picture.h"
#include "tests/server/ingest/drive/euroc_folder.h"
#include "tests/server/ingest/video/video_log.h"

namespace parkade {
namespace {

constexpr std::int64_t kBegin = 1'700'000'000'000'000'000, kMs = 1'000'000;
constexpr int kImages = 50;
constexpr double kLossOfCodec = 3;  // [gray levels]

struct VideoLogPlan {
  MessageEncoding encoding = MessageEncoding::kCdr;
  std::string type = "sensor_msgs/CompressedImage";
  std::string topic = "/cam0/image_raw/compressed";
  std::string format = "h264";
  VideoWriterOptions video = {};
  std::vector<int> lost = {};  ///< numbers of images that are not in the log
};

/// Five seconds of the moving disk, ten images a second.
MemorySource MakeVideoLog(const VideoLogPlan& plan) {
  const auto packets = EncodeVideo(MovingDisks(kImages), plan.video);
  MemorySource log(plan.encoding);
  for (int ms = 0; ms <= 5000; ms += 5) {
    const std::int64_t now = kBegin + ms * kMs;
    log.Add("/imu", "sensor_msgs/Imu", now, ImuBytes(log.Writer(), now, "imu"));
    const int number = ms / 100;
    if (ms % 100 != 0 || number >= kImages || std::ranges::count(plan.lost, number) > 0) continue;
    log.Add(plan.topic, plan.type, now,
            VideoBytes(log.Writer(), plan.encoding, plan.type, now, plan.format,
                       packets[static_cast<std::size_t>(number)]));
  }
  return log;
}

std::unique_ptr<RecordedDrive> Open(const MemorySource& log) {
  const TestFolder folder;
  WriteRig(RigOfVideo(), folder.path());
  OpenLogOptions options;
  options.rig_folder = folder.path();
  options.warn = false;
  options.num_decode_threads = 4;
  return OpenDriveLog(std::make_shared<MemorySource>(log), "drive.mcap", options);
}

int NumberOf(Timestamp time) { return static_cast<int>((time.ns - kBegin) / (100 * kMs)); }

/// Numbers of the images that a pass delivers; each is compared with what was encoded.
std::vector<int> NumbersRead(const DriveLog& drive, const ReadOptions& options) {
  std::vector<int> numbers;
  const auto stream = drive.Read(options);
  while (const auto record = stream->Next())
    if (const auto* frame = std::get_if<CameraFrame>(&*record)) {
      numbers.push_back(NumberOf(frame->time));
      cv::Mat gray;
      cv::extractChannel(frame->image, gray, 0);
      EXPECT_LT(Difference(gray, MovingDisk(numbers.back())), kLossOfCodec) << numbers.back();
    }
  return numbers;
}

std::vector<int> Count(int begin, int end, int step = 1) {
  std::vector<int> numbers;
  for (int i = begin; i < end; i += step) numbers.push_back(i);
  return numbers;
}

TEST(VideoDrive, AllTypesOfMessagesAreRead) {
  std::vector<VideoLogPlan> plans(3);
  plans[1].type = "foxglove_msgs/CompressedVideo";
  plans[1].topic = "/cam0/image_raw";
  plans[2].type = "ffmpeg_image_transport_msgs/FFMPEGPacket";
  plans[2].topic = "/cam0/image_raw/ffmpeg";
  plans[2].format = "libx265";
  plans[2].video = WithEncoder("libx265");
  for (VideoLogPlan& plan : plans)
    for (const MessageEncoding encoding : {MessageEncoding::kRos1, MessageEncoding::kCdr}) {
      plan.encoding = encoding;
      const auto drive = Open(MakeVideoLog(plan));
      ReadOptions options;
      for (const bool grayscale : {true, false}) {
        options.grayscale = grayscale;
        EXPECT_EQ(NumbersRead(*drive, options), Count(0, kImages)) << plan.type;
      }
      EXPECT_TRUE(drive->health().Warnings().empty());
    }
}

TEST(VideoDrive, ImagesMayBeChosen) {
  for (const int interval : {7, 1000}) {
    VideoLogPlan plan;
    plan.video.key_frame_interval = interval;
    const auto drive = Open(MakeVideoLog(plan));
    ReadOptions options;
    options.wants_image = [](int, Timestamp time) { return NumberOf(time) % 9 == 4; };

    EXPECT_EQ(NumbersRead(*drive, options), Count(4, kImages, 9));
  }
}

TEST(VideoDrive, WhatCannotBeDecodedIsCountedByItsReason) {
  VideoLogPlan plan;
  plan.lost = {0, 1, 2, 3, 24};
  const auto drive = Open(MakeVideoLog(plan));

  std::vector<int> expected = Count(10, 24);
  for (const int number : Count(30, kImages)) expected.push_back(number);
  EXPECT_EQ(NumbersRead(*drive, {}), expected);
  const StreamHealth camera = drive->health().streams.back();
  EXPECT_EQ(camera.role, "cam0");
  EXPECT_EQ(camera.num_delivered, expected.size());
  EXPECT_EQ(camera.Dropped(DropReason::kWaitsForKeyFrame), 6u);
  EXPECT_EQ(camera.Dropped(DropReason::kDamaged), 5u);
}

TEST(VideoDrive, APictureInMidGroupIsDecodedFromItsKeyFrameOn) {
  for (const bool repeats_parameters : {true, false}) {
    VideoLogPlan plan;
    plan.video.repeats_parameters = repeats_parameters;
    plan.lost = {35};
    const MemorySource log = MakeVideoLog(plan);
    const PictureIndex index =
        DecodePictureIndex(EncodePictureIndex(IndexPictures(log, RigOfVideo())));
    const IndexedCamera& camera = index.cameras.front();
    ASSERT_EQ(camera.images.size(), kImages - 1u);
    for (const std::size_t number : {47u, 0u, 26u, 10u, 34u}) {
      const std::size_t at = number < 35 ? number : number - 1;
      const Picture picture = ReadPicture(log, camera, camera.images[at], 0);
      const cv::Mat shown =
          cv::imdecode(std::vector<unsigned char>(picture.jpeg.begin(), picture.jpeg.end()),
                       cv::IMREAD_GRAYSCALE);
      EXPECT_LT(Difference(shown, MovingDisk(static_cast<int>(number))), 2 * kLossOfCodec);
    }
    EXPECT_THROW(ReadPicture(log, camera, camera.images[36], 0), Error);
  }
}

TEST(VideoDrive, IsPixelsInACleanLog) {
  VideoLogPlan plan;
  plan.lost = {0};  // up to the next key frame nothing can be decoded
  const MemorySource log = MakeVideoLog(plan);
  const TestFolder folder;
  const std::filesystem::path rig = folder.path() / "rig", out = folder.path() / "clean.mcap";
  std::filesystem::create_directories(rig);
  WriteRig(RigOfVideo(), rig);

  const Conversion conversion = ConvertLog(std::make_shared<MemorySource>(log), "drive", out,
                                           {.rig_folder = rig, .warn = false});
  const auto clean = OpenDriveLog(out, {.rig_folder = conversion.rig, .warn = false});

  const std::vector<int> numbers = NumbersRead(*Open(log), {});
  EXPECT_LT(numbers.size(), static_cast<std::size_t>(kImages));
  EXPECT_EQ(NumbersRead(*clean, {}), numbers);
  EXPECT_EQ(clean->health().streams.at(1).topic, "/cam0/image_raw");
  EXPECT_EQ(conversion.drives.at(0).num_left_out, kImages - 1 - numbers.size());
}

}  // namespace
}  // namespace parkade

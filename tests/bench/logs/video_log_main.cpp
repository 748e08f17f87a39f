// A drive's images as a video: what a codec costs beside JPEGs of the same drive.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "server/ingest/containers/open_log_source.h"
#include "server/ingest/messages/message_encoding.h"
#include "server/ingest/writing/mcap_writer.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/support/video_writer.h"

namespace parkade {
namespace {

constexpr const char* kFooter =
    R"(Writes LOG (ROS 2) anew; its JPEGs become H.264 or H.265, gray, one video per camera, or with --jpeg
gray JPEGs once more, for comparison. Masks are left out.
Example: parkade-video-log drive.mcap drive_h264.mcap --rate-factor 23
         parkade map drive_h264.mcap --rig drive.truth/rig --out map --odometry-only)";

struct CommandLine {
  std::filesystem::path log, out;
  int rate_factor = 23, key_frame_interval = 10, jpeg_quality = 0;
  bool is_h265 = false;
};

bool IsPicture(const TopicInfo& topic) {
  return topic.type == "sensor_msgs/CompressedImage" &&
         topic.topic.find("semantic") == std::string::npos;
}

/// One camera's images while they are encoded.
struct Video {
  std::vector<cv::Mat> images;
  std::vector<std::vector<std::uint8_t>> packets;
  std::size_t next = 0;
};

std::vector<bool> Wanted(const std::vector<TopicInfo>& topics, bool only_pictures) {
  std::vector<bool> wanted;
  wanted.reserve(topics.size());
  for (const TopicInfo& topic : topics)
    wanted.push_back(IsPicture(topic) ||
                     (!only_pictures && topic.type != "sensor_msgs/CompressedImage"));
  return wanted;
}

std::string FormatOf(const CommandLine& line) {
  if (line.jpeg_quality > 0) return "jpeg";
  return line.is_h265 ? "h265" : "h264";
}

std::vector<std::vector<std::uint8_t>> Encode(const std::vector<cv::Mat>& images,
                                              const CommandLine& line) {
  if (line.jpeg_quality == 0) {
    VideoWriterOptions options = WithEncoder(line.is_h265 ? "libx265" : "libx264");
    options.rate_factor = line.rate_factor;
    options.key_frame_interval = line.key_frame_interval;
    return EncodeVideo(images, options);
  }
  std::vector<std::vector<std::uint8_t>> packets(images.size());
  for (std::size_t i = 0; i < images.size(); ++i)
    cv::imencode(".jpg", images[i], packets[i], {cv::IMWRITE_JPEG_QUALITY, line.jpeg_quality});
  return packets;
}

/// The videos, by topic. The size of the JPEGs is added to `num_bytes`.
std::map<int, Video> EncodeAll(const MessageSource& source, const CommandLine& line,
                               std::size_t& num_bytes) {
  std::map<int, Video> videos;
  const auto stream = source.Read(Wanted(source.topics(), true));
  while (const std::optional<RawMessage> message = stream->Next()) {
    const TopicInfo& topic = source.topics()[static_cast<std::size_t>(message->topic)];
    const auto jpeg = DecodeCompressedImage(message->data, topic.encoding, topic.type).data;
    num_bytes += jpeg.size();
    videos[message->topic].images.push_back(cv::imdecode(
        cv::Mat(1, static_cast<int>(jpeg.size()), CV_8UC1, const_cast<std::uint8_t*>(jpeg.data())),
        cv::IMREAD_GRAYSCALE));
    Require(!videos[message->topic].images.back().empty(), ErrorCode::kInvalidInput,
            "an image of " + topic.topic + " cannot be decoded");
  }
  for (auto& [topic, video] : videos) {
    video.packets = Encode(video.images, line);
    video.images.clear();
  }
  return videos;
}

int Run(const CommandLine& line) {
  const auto source = OpenLogSource(line.log, std::filesystem::temp_directory_path());
  for (const TopicInfo& topic : source->topics())
    Require(topic.encoding == MessageEncoding::kCdr, ErrorCode::kInvalidInput,
            topic.topic + " is not of ROS 2: parkade convert makes the log one");
  std::size_t num_bytes_before = 0, num_bytes = 0;
  std::map<int, Video> videos = EncodeAll(*source, line, num_bytes_before);
  McapWriter writer(line.out, "ros2");
  std::vector<int> channels;
  for (const TopicInfo& topic : source->topics()) {
    std::string type = topic.type;
    type.insert(type.find('/'), "/msg");
    channels.push_back(
        writer.AddChannel(topic.topic, type, topic.schema ? *topic.schema : "", "cdr"));
  }
  const auto stream = source->Read(Wanted(source->topics(), false));
  while (const std::optional<RawMessage> message = stream->Next()) {
    const auto index = static_cast<std::size_t>(message->topic);
    const TopicInfo& topic = source->topics()[index];
    if (!IsPicture(topic)) {
      writer.Write(channels[index], message->log_time, message->data);
      continue;
    }
    Video& video = videos.at(message->topic);
    const std::vector<std::uint8_t>& packet = video.packets.at(video.next++);
    num_bytes += packet.size();
    const MessageHeader header =
        DecodeCompressedImage(message->data, topic.encoding, topic.type).header;
    writer.Write(channels[index], message->log_time,
                 EncodeCompressedImage({header, FormatOf(line), packet}));
  }
  writer.Close();
  std::printf("images took %.1f MB, now they take %.1f MB\n",
              1e-6 * static_cast<double>(num_bytes_before), 1e-6 * static_cast<double>(num_bytes));
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app("Writes a drive's images anew as a video.", "parkade-video-log");
  CommandLine line;
  app.add_option("log", line.log)->required();
  app.add_option("out", line.out, "FILE.mcap")->required();
  app.add_option("--rate-factor", line.rate_factor, "Constant rate factor")->capture_default_str();
  app.add_option("--key-frames", line.key_frame_interval, "Every so many images")
      ->capture_default_str();
  app.add_option("--jpeg", line.jpeg_quality, "No video: gray JPEGs of this quality")
      ->check(CLI::Range(1, 100));
  app.add_flag("--h265", line.is_h265, "Instead of H.264");
  app.footer(kFooter);
  return RunBench(app, argc, argv, 1, [&] { return Run(line); });
}

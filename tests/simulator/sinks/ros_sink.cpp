#include "tests/simulator/sinks/ros_sink.h"

namespace parkade::simulator {
namespace {

std::filesystem::path Unfinished(std::filesystem::path file) { return file += ".part"; }

std::variant<McapWriter, Rosbag1Writer> OpenWriter(const std::filesystem::path& file,
                                                   const std::filesystem::path& unfinished) {
  using Writer = std::variant<McapWriter, Rosbag1Writer>;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  if (file.extension() == ".bag") return Writer(std::in_place_type<Rosbag1Writer>, unfinished);
  return Writer(std::in_place_type<McapWriter>, unfinished, "ros2");
}

}  // namespace

RosSink::RosSink(const std::filesystem::path& file, const Rig& rig)
    : file_(file),
      unfinished_(Unfinished(file)),
      rig_(rig),
      writer_(OpenWriter(file, unfinished_)) {
  imu_ = AddChannel(rig.imu.topic, ImuType());
  for (const RigCamera& camera : rig.cameras)
    images_.push_back(AddChannel(camera.topic + "/compressed", CompressedImageType()));
  masks_.resize(rig.cameras.size());
}

RosEncoding RosSink::encoding() const {
  return std::holds_alternative<McapWriter>(writer_) ? RosEncoding::kCdr : RosEncoding::kRos1;
}

RosSink::Channel RosSink::AddChannel(const std::string& topic, const RosType& type) {
  const std::string name = topic.starts_with("/") ? topic : "/" + topic;
  if (auto* mcap = std::get_if<McapWriter>(&writer_))
    return {mcap->AddChannel(name, type.ros2_name, type.ros2_definition, "cdr")};
  return {std::get<Rosbag1Writer>(writer_).AddChannel(name, type.ros1_name, type.ros1_definition,
                                                      type.ros1_md5)};
}

RosHeader RosSink::NextHeader(Channel& channel, Timestamp time, const std::string& frame) {
  return {channel.num_messages++, time, frame};
}

void RosSink::WriteMessage(const Channel& channel, Timestamp time,
                           const std::vector<std::uint8_t>& bytes) {
  std::visit([&](auto& writer) { writer.Write(channel.id, ArrivalOr(time), bytes); }, writer_);
}

void RosSink::Write(const ImuSample& sample) {
  WriteMessage(imu_, sample.time,
               EncodeImu(NextHeader(imu_, sample.time, "imu"), sample, encoding()));
}

void RosSink::Write(const WheelSample& sample) {
  if (last_wheels_) {
    const double seconds = sample.time - last_wheels_->time;
    const double turn = 0.5 * (sample.yaw_rate + last_wheels_->yaw_rate) * seconds;
    const double step = 0.5 * (sample.forward_speed + last_wheels_->forward_speed) * seconds;
    // The chord of a short arc points half the turn to the side.
    odom_from_body_ =
        odom_from_body_ *
        Rigid3{ExpSo3({0, 0, turn}), {step * std::cos(turn / 2), step * std::sin(turn / 2), 0}};
  }
  last_wheels_ = sample;
  if (wheels_.id < 0) wheels_ = AddChannel(rig_.vehicle->wheel_topic, OdometryType());
  WriteMessage(wheels_, sample.time,
               EncodeOdometry(NextHeader(wheels_, sample.time, "odom"), "base_link", sample,
                              odom_from_body_, encoding()));
}

void RosSink::Write(const GnssFix& fix) {
  if (gnss_.id < 0) gnss_ = AddChannel(rig_.vehicle->gnss_topic, NavSatFixType());
  WriteMessage(gnss_, fix.time,
               EncodeNavSatFix(NextHeader(gnss_, fix.time, "gnss"), fix, encoding()));
}

void RosSink::WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) {
  const RosHeader header = NextHeader(images_[camera], time, rig_.cameras[camera].name);
  WriteMessage(images_[camera], time, EncodeCompressedImage(header, "jpeg", jpeg, encoding()));
}

void RosSink::WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) {
  // A topic that nothing is written to would look like a stream that was lost.
  if (masks_[camera].id < 0)
    masks_[camera] = AddChannel(rig_.cameras[camera].name + "/semantic", CompressedImageType());
  const RosHeader header = NextHeader(masks_[camera], time, rig_.cameras[camera].name);
  WriteMessage(masks_[camera], time, EncodeCompressedImage(header, "png", png, encoding()));
}

void RosSink::Close() {
  std::visit([](auto& writer) { writer.Close(); }, writer_);
  std::filesystem::rename(unfinished_, file_);
}

}  // namespace parkade::simulator

#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/ingest/writing/mcap_writer.h"
#include "tests/simulator/sinks/drive_sink.h"
#include "tests/simulator/sinks/encode_ros_messages.h"
#include "tests/support/rosbag1_writer.h"

namespace parkade::simulator {

/// A ROS 1 bag (.bag) or a ROS 2 MCAP (.mcap). Written beside its name and
/// renamed by Close(), so that a log of that name is always whole.
class RosSink : public DriveSink {
 public:
  RosSink(const std::filesystem::path& file, const Rig& rig);

  void Write(const ImuSample& sample) override;
  void Write(const WheelSample& sample) override;
  void Write(const GnssFix& fix) override;
  void WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) override;
  void WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) override;
  void Close() override;

 private:
  struct Channel {
    int id = -1;
    std::uint32_t num_messages = 0;
  };
  Channel AddChannel(const std::string& topic, const RosType& type);
  RosHeader NextHeader(Channel& channel, Timestamp time, const std::string& frame);
  void WriteMessage(const Channel& channel, Timestamp time, const std::vector<std::uint8_t>& bytes);
  RosEncoding encoding() const;

  std::filesystem::path file_, unfinished_;
  Rig rig_;
  std::variant<McapWriter, Rosbag1Writer> writer_;
  Channel imu_, wheels_, gnss_;
  std::vector<Channel> images_, masks_;
  Rigid3 odom_from_body_;  ///< dead-reckoned
  std::optional<WheelSample> last_wheels_;
};

}  // namespace parkade::simulator

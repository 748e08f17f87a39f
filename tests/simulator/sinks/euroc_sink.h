#pragma once

#include <fstream>
#include <vector>

#include "tests/simulator/sinks/drive_sink.h"

namespace parkade::simulator {

/// An EuRoC folder: FOLDER/mav0/{cam*,imu0,odom0,gnss0} with data.csv and sensor.yaml.
class EurocSink : public DriveSink {
 public:
  EurocSink(const std::filesystem::path& folder, const Rig& rig);

  void Write(const ImuSample& sample) override;
  void Write(const WheelSample& sample) override;
  void Write(const GnssFix& fix) override;
  void WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) override;
  void WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) override;
  void Close() override;

 private:
  /// A data.csv that comes into being with its first line.
  struct Table {
    std::filesystem::path folder;
    const char* header = "";
    std::ofstream file;
  };
  void WriteLine(Table& table, const std::string& line);
  void WriteFrame(Table& table, Timestamp time, const char* suffix,
                  std::span<const std::uint8_t> content);

  std::filesystem::path root_;
  Table imu_, wheels_, gnss_;
  std::vector<Table> images_, masks_;
};

}  // namespace parkade::simulator

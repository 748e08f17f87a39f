#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tests/simulator/common/fault_options.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/sinks/drive_sink.h"

namespace parkade::simulator {

/// Lets records through to another sink, except for the faults of recorders: gaps, wrong stamps,
/// records twice or out of order, damaged images. Masks share the gaps and stamps of their images.
class FaultySink : public DriveSink {
 public:
  /// Keeps a reference to `sink`. Times of faults count from `epoch`.
  FaultySink(DriveSink& sink, const FaultOptions& faults, Timestamp epoch, std::uint64_t seed);

  void Write(const ImuSample& sample) override;
  void Write(const WheelSample& sample) override;
  void Write(const GnssFix& fix) override;
  void WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) override;
  void WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) override;
  void Close() override;

  /// How many records each fault has met, by the fault's name and stream: "imu_gap",
  /// "duplicates.cam1", ...
  const std::map<std::string, size_t>& counts() const { return counts_; }

 private:
  struct Image {
    size_t camera = 0;
    Timestamp time;
    std::vector<std::uint8_t> file;
  };
  struct Mask : Image {};
  using Record = std::variant<ImuSample, WheelSample, GnssFix, Image, Mask>;

  /// A sensor's stream and the record that waits for its successor.
  struct Stream {
    std::string name;
    Random random;
    std::optional<Record> held;
  };

  void Pass(Record record, Stream& stream);
  void Deliver(const Record& record);
  bool IsInGap(const Record& record, double time) const;
  double StampError(const Record& record, const std::string& stream, double time);
  void Damage(std::vector<std::uint8_t>& jpeg, Random& random);
  double SinceStart(Timestamp time) const { return time - epoch_; }

  DriveSink& sink_;
  FaultOptions faults_;
  Timestamp epoch_;
  Stream imu_, wheels_, gnss_;
  std::vector<Stream> cameras_;
  std::map<std::string, size_t> counts_;
};

}  // namespace parkade::simulator

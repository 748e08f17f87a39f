#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/drive_log.h"

namespace parkade::simulator {

/// Takes a drive record by record, in order of time, and writes it in one format.
class DriveSink {
 public:
  virtual ~DriveSink() = default;

  /// When the next records reach the recorder, for logs that keep that beside the stamps. Without
  /// it: at their stamps.
  void ArriveAt(Timestamp time) { arrival_ = time; }

  virtual void Write(const ImuSample& sample) = 0;
  virtual void Write(const WheelSample& sample) = 0;
  virtual void Write(const GnssFix& fix) = 0;
  /// `jpeg` and `png` are whole files.
  virtual void WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) = 0;
  virtual void WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) = 0;
  /// Without it the output is as after a crash. Throws when the output could not be written whole.
  virtual void Close() = 0;

 protected:
  Timestamp ArrivalOr(Timestamp stamp) const { return arrival_.value_or(stamp); }

 private:
  std::optional<Timestamp> arrival_;
};

}  // namespace parkade::simulator

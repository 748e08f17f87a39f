#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/timestamp.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// The stamps of one stream as the log has them, in its order.
struct StampSequence {
  std::vector<Timestamp> stamps;
  std::vector<Timestamp>
      log_times;  ///< when the recorder took the message; where it does not say, the stamp
  std::vector<std::uint64_t> orders;  ///< among the messages of all streams

  double StepAt(std::size_t i) const { return stamps[i] - stamps[i - 1]; }  ///< [s]
  double Period() const;  ///< [s] median of the steps that are no leaps
};

/// Reads the stamps of all messages of the streams, one sequence each.
std::vector<StampSequence> ReadStamps(const MessageSource& source,
                                      const std::vector<SensorStream>& streams);

/// Messages [begin, end) of a stream between two leaps of its clock.
struct StampRun {
  std::size_t begin = 0, end = 0;
  std::size_t size() const { return end - begin; }
};

/// The runs of a stream without its glitches: a few messages off the line that the others go on. A
/// leap is a step of more than 2 s ahead or 0.5 s back; or one a little back, after which all
/// messages come as much later by the recorder's clock.
std::vector<StampRun> RunsOf(const StampSequence& sequence);

/// A leap between two runs of a stream.
struct ClockLeap {
  std::size_t before = 0, after = 0;  ///< the messages on either side
  double step = 0;                    ///< [s] by the stamps
  double log_step = 0;                ///< [s] by the recorder's clock

  /// Whether nothing came for as long, by the recorder's clock.
  bool IsGap() const;
  /// [s] to add to all stamps behind a leap of one stream alone, so that they go on as before: by
  /// one period, or by as many as the recorder waited.
  double Correction(double period) const;
};

ClockLeap LeapBetween(const StampSequence& sequence, const StampRun& a, const StampRun& b);

}  // namespace parkade

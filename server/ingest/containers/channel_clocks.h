#pragma once

#include <cstdint>
#include <map>

#include "core/timestamp.h"

namespace parkade {

/// Whether the recorder's clock was set back while it wrote a log, so that an order by time would
/// mix what came before with what came behind.
class ChannelClocks {
 public:
  /// Messages of a channel in the order of the file.
  void Add(std::uint32_t channel, Timestamp log_time);

  /// True where times go back by more than 2 s within most channels, each time at one place of a
  /// few. Channels that lie behind each other in a file do not, nor do messages that come late.
  bool WereSetBack() const;

 private:
  struct Clock {
    Timestamp latest;  ///< since it was set back
    std::uint64_t num_messages = 0;
    std::uint64_t num_steps_back = 0;
  };
  std::map<std::uint32_t, Clock> clocks_;
};

}  // namespace parkade

#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/ingest/drive/arrival_stream.h"

namespace parkade {

/// Puts the records of all streams in order of time. A record is passed on once the newest time
/// seen is `reorder_window` ahead of it; one that comes later than that is counted as late and
/// dropped. Equal times: in the order of the log. Holds at most 256 MB of images, and then passes
/// on early.
class ArrivalMerger {
 public:
  ArrivalMerger(std::unique_ptr<ArrivalStream> arrivals, double reorder_window);

  std::optional<Arrival> Next();

  /// Counts of this pass so far, late records included.
  std::vector<StreamHealth> Health() const;
  const DamageReport& damage() const { return arrivals_->damage(); }

 private:
  struct Held {
    std::uint64_t sequence;
    Arrival arrival;
  };
  static bool IsLater(const Held& a, const Held& b);

  void Hold(Arrival arrival);
  Arrival Pop();
  bool MustPass() const;

  std::unique_ptr<ArrivalStream> arrivals_;
  double reorder_window_;   ///< [s]
  std::vector<Held> heap_;  ///< earliest first
  std::size_t num_bytes_ = 0;
  std::uint64_t next_sequence_ = 0;
  std::optional<Timestamp> front_, last_passed_;
  std::vector<std::uint64_t> num_late_;
  bool is_drained_ = false;
};

}  // namespace parkade

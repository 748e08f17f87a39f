#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/drive_log.h"
#include "server/ingest/drive/arrival_merger.h"

namespace parkade {

/// The result of decoding an arrival: a record, or the reason why there is none.
struct DecodedArrival {
  std::optional<SensorRecord> record;
  DropReason reason = DropReason::kDamaged;
};

/// Reads and decodes ahead of its caller on worker threads, in bounded memory, and passes records
/// on in order.
///
/// Outside core/parallel, threads live here only: ParallelFor returns when all is done, but reading
/// ahead has to go on while the caller works. Workers share nothing but the queue: each takes the
/// next arrival under `source_mutex_`, appends an empty slot, and fills it while the others go on.
class DecodeAhead {
 public:
  using Decode = std::function<DecodedArrival(Arrival arrival)>;

  struct Limits {
    int num_threads = 1;
    std::size_t max_images = 8;  ///< decoded or in work at once
    std::size_t max_records = 4096;
  };

  /// `decode` is called from several threads at once.
  DecodeAhead(std::unique_ptr<ArrivalMerger> arrivals, Decode decode, const Limits& limits);
  ~DecodeAhead();
  DecodeAhead(const DecodeAhead&) = delete;
  DecodeAhead& operator=(const DecodeAhead&) = delete;

  /// The next arrival with its record, or nothing at the end. Rethrows what a worker threw. Call
  /// from one thread.
  struct Item {
    int stream = 0;
    DecodedArrival decoded;
  };
  std::optional<Item> Next();

  /// The source, once Next() has returned nothing.
  const ArrivalMerger& source() const { return *arrivals_; }

 private:
  struct Slot {
    Item item;
    bool is_image = false, is_done = false;
    std::exception_ptr error;
  };

  void Work();
  /// Waits for room and appends the slot of the next arrival; nothing at the end.
  std::optional<std::pair<std::shared_ptr<Slot>, Arrival>> TakeNext();
  void Finish(const std::shared_ptr<Slot>& slot, DecodedArrival decoded, std::exception_ptr error);

  const Decode decode_;
  const Limits limits_;
  std::mutex source_mutex_;  ///< guards arrivals_; taken before queue_mutex_
  std::unique_ptr<ArrivalMerger> arrivals_;
  std::mutex queue_mutex_;  ///< guards all below
  std::condition_variable has_room_, has_result_;
  std::deque<std::shared_ptr<Slot>> slots_;
  std::size_t num_images_ = 0;
  bool is_drained_ = false, is_stopping_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace parkade

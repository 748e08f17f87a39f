#include "server/ingest/drive/arrival_merger.h"

#include <algorithm>
#include <tuple>

namespace parkade {
namespace {

constexpr std::size_t kMaxBytes = 256 << 20;  // half a second of six raw color cameras

std::size_t SizeOf(const Arrival& arrival) {
  const auto* image = std::get_if<EncodedImage>(&arrival.content);
  return sizeof(Arrival) + (image ? image->message.data.size() : 0);
}

}  // namespace

ArrivalMerger::ArrivalMerger(std::unique_ptr<ArrivalStream> arrivals, double reorder_window)
    : arrivals_(std::move(arrivals)),
      reorder_window_(reorder_window),
      num_late_(arrivals_->health().size(), 0) {}

bool ArrivalMerger::IsLater(const Held& a, const Held& b) {
  return std::tie(a.arrival.time, a.arrival.stream, a.sequence) >
         std::tie(b.arrival.time, b.arrival.stream, b.sequence);
}

std::optional<Arrival> ArrivalMerger::Next() {
  while (!is_drained_ && !MustPass()) {
    std::optional<Arrival> arrival = arrivals_->Next();
    if (!arrival) {
      is_drained_ = true;
    } else if (last_passed_ && arrival->time < *last_passed_) {
      ++num_late_[static_cast<std::size_t>(arrival->stream)];
    } else {
      Hold(std::move(*arrival));
    }
  }
  if (heap_.empty()) return std::nullopt;
  return Pop();
}

bool ArrivalMerger::MustPass() const {
  if (heap_.empty()) return false;
  return *front_ - heap_.front().arrival.time > reorder_window_ || num_bytes_ > kMaxBytes;
}

void ArrivalMerger::Hold(Arrival arrival) {
  if (!front_ || arrival.time > *front_) front_ = arrival.time;
  num_bytes_ += SizeOf(arrival);
  heap_.push_back({next_sequence_++, std::move(arrival)});
  std::push_heap(heap_.begin(), heap_.end(), IsLater);
}

Arrival ArrivalMerger::Pop() {
  std::pop_heap(heap_.begin(), heap_.end(), IsLater);
  Arrival arrival = std::move(heap_.back().arrival);
  heap_.pop_back();
  num_bytes_ -= SizeOf(arrival);
  last_passed_ = arrival.time;
  return arrival;
}

std::vector<StreamHealth> ArrivalMerger::Health() const {
  std::vector<StreamHealth> health = arrivals_->health();
  for (std::size_t i = 0; i < health.size(); ++i)
    health[i].Dropped(DropReason::kLate) = num_late_[i];
  return health;
}

}  // namespace parkade

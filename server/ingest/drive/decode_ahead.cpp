#include "server/ingest/drive/decode_ahead.h"

namespace parkade {

DecodeAhead::DecodeAhead(std::unique_ptr<ArrivalMerger> arrivals, Decode decode,
                         const Limits& limits)
    : decode_(std::move(decode)), limits_(limits), arrivals_(std::move(arrivals)) {
  for (int i = 0; i < limits_.num_threads; ++i) workers_.emplace_back([this] { Work(); });
}

DecodeAhead::~DecodeAhead() {
  {
    const std::lock_guard lock(queue_mutex_);
    is_stopping_ = true;
  }
  has_room_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

std::optional<DecodeAhead::Item> DecodeAhead::Next() {
  std::shared_ptr<Slot> slot;
  {
    std::unique_lock lock(queue_mutex_);
    has_result_.wait(lock,
                     [this] { return slots_.empty() ? is_drained_ : slots_.front()->is_done; });
    if (slots_.empty()) return std::nullopt;
    slot = std::move(slots_.front());
    slots_.pop_front();
    if (slot->is_image) --num_images_;
  }
  has_room_.notify_one();
  if (slot->error) std::rethrow_exception(slot->error);
  return std::move(slot->item);
}

void DecodeAhead::Work() {
  while (auto next = TakeNext()) {
    auto& [slot, arrival] = *next;
    DecodedArrival decoded;
    std::exception_ptr error;
    try {
      decoded = decode_(std::move(arrival));
    } catch (...) {
      error = std::current_exception();  // rethrown by Next()
    }
    Finish(slot, std::move(decoded), error);
  }
}

std::optional<std::pair<std::shared_ptr<DecodeAhead::Slot>, Arrival>> DecodeAhead::TakeNext() {
  const std::lock_guard source_lock(source_mutex_);
  {
    std::unique_lock lock(queue_mutex_);
    has_room_.wait(lock, [this] {
      return is_stopping_ ||
             (num_images_ < limits_.max_images && slots_.size() < limits_.max_records);
    });
    if (is_stopping_ || is_drained_) return std::nullopt;
  }
  std::optional<Arrival> arrival;
  auto slot = std::make_shared<Slot>();
  try {
    arrival = arrivals_->Next();
  } catch (...) {
    slot->error = std::current_exception();  // rethrown by Next()
    slot->is_done = true;
  }
  const std::lock_guard lock(queue_mutex_);
  if (!arrival) {
    if (slot->error) slots_.push_back(std::move(slot));
    is_drained_ = true;
    has_result_.notify_all();
    return std::nullopt;
  }
  slot->item.stream = arrival->stream;
  slot->is_image = std::holds_alternative<EncodedImage>(arrival->content);
  if (slot->is_image) ++num_images_;
  slots_.push_back(slot);
  return std::pair(std::move(slot), std::move(*arrival));
}

void DecodeAhead::Finish(const std::shared_ptr<Slot>& slot, DecodedArrival decoded,
                         std::exception_ptr error) {
  {
    const std::lock_guard lock(queue_mutex_);
    slot->item.decoded = std::move(decoded);
    slot->error = std::move(error);
    slot->is_done = true;
  }
  has_result_.notify_one();
}

}  // namespace parkade

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

enum class DeliveryState {
  kWaiting,    ///< to be sent, for the first time or again
  kDelivered,  ///< the receiver has taken it
  kFailed,     ///< given up
};

/// "waiting", "delivered", "failed".
const char* ToText(DeliveryState state);

/// One event for one webhook.
struct Delivery {
  std::int64_t sequence = 0;
  std::string id;
  std::string webhook;  ///< id
  std::string event;
  std::string body;  ///< JSON, as it is sent
  DeliveryState state = DeliveryState::kWaiting;
  int attempts = 0;
  std::string due_at;                       ///< of the next attempt
  std::optional<std::int64_t> status;       ///< of HTTP, at the last attempt
  std::optional<std::int64_t> duration_ms;  ///< [ms] that it took
  std::optional<std::string> error;         ///< one sentence
  std::string created_at;
  std::optional<std::string> finished_at;
};

// Rows of `deliveries`: both what is still to be sent and the log of what was. Each webhook has at
// most kMaxWaiting of the former, older ones are given up, and kMaxDelivered of the latter.
constexpr int kMaxWaiting = 1000, kMaxDelivered = 500;

/// As waiting, due at once.
void InsertDelivery(Connection& connection, const Delivery& delivery);

/// Throws Error{kNotFound}.
Delivery FindDelivery(Connection& connection, const std::string& id);

/// Newest first.
std::vector<Delivery> ListDeliveries(Connection& connection, const std::string& webhook,
                                     const Page& page);

/// The oldest delivery of each webhook that is due at `now`.
std::vector<Delivery> DueDeliveries(Connection& connection, const std::string& now);

std::int64_t CountDeliveries(Connection& connection, DeliveryState state);

/// Stores what an attempt came to: state, attempts, time of the next one, status, error. Nothing
/// happens where the webhook was deleted meanwhile.
void UpdateDelivery(Connection& connection, const Delivery& delivery);

}  // namespace parkade

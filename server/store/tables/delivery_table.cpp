#include "server/store/tables/delivery_table.h"

#include <array>
#include <utility>

#include "core/error.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, id, webhook, event, body, state, attempts, due_at, status, duration_ms, "
    "error, created_at, finished_at FROM deliveries ";

constexpr std::array<std::pair<DeliveryState, const char*>, 3> kStates = {
    {{DeliveryState::kWaiting, "waiting"},
     {DeliveryState::kDelivered, "delivered"},
     {DeliveryState::kFailed, "failed"}}};

DeliveryState StateFromText(const std::string& text) {
  for (const auto& [state, known] : kStates)
    if (text == known) return state;
  throw Error(ErrorCode::kInternal, "the database holds the unknown state '" + text + "'");
}

Delivery FromRow(const Statement& row) {
  Delivery delivery;
  delivery.sequence = row.Integer(0);
  delivery.id = row.Text(1);
  delivery.webhook = row.Text(2);
  delivery.event = row.Text(3);
  delivery.body = row.Text(4);
  delivery.state = StateFromText(row.Text(5));
  delivery.attempts = static_cast<int>(row.Integer(6));
  delivery.due_at = row.Text(7);
  delivery.status = OptionalInteger(row, 8);
  delivery.duration_ms = OptionalInteger(row, 9);
  delivery.error = OptionalText(row, 10);
  delivery.created_at = row.Text(11);
  delivery.finished_at = OptionalText(row, 12);
  return delivery;
}

std::vector<Delivery> FromRows(Statement query) {
  std::vector<Delivery> deliveries;
  while (query.Step()) deliveries.push_back(FromRow(query));
  return deliveries;
}

/// Forgets the oldest of what has ended.
void TrimLog(Connection& connection, const std::string& webhook) {
  connection.Execute(
      R"(DELETE FROM deliveries WHERE webhook = ?1 AND state != 'waiting' AND sequence <=
           (SELECT sequence FROM deliveries WHERE webhook = ?1 AND state != 'waiting'
              ORDER BY sequence DESC LIMIT 1 OFFSET ?2))",
      webhook, kMaxDelivered);
}

/// Gives up the oldest of what waits for a receiver that takes nothing.
void TrimWaiting(Connection& connection, const std::string& webhook) {
  const int given_up = connection.Execute(
      R"(UPDATE deliveries SET state = 'failed', error = ?3, finished_at = ?4
         WHERE webhook = ?1 AND state = 'waiting' AND sequence <=
           (SELECT sequence FROM deliveries WHERE webhook = ?1 AND state = 'waiting'
              ORDER BY sequence DESC LIMIT 1 OFFSET ?2))",
      webhook, kMaxWaiting,
      "given up: more than " + std::to_string(kMaxWaiting) + " newer ones wait", NowUtc());
  if (given_up > 0) TrimLog(connection, webhook);
}

}  // namespace

const char* ToText(DeliveryState state) {
  for (const auto& [known, text] : kStates)
    if (known == state) return text;
  throw Error(ErrorCode::kInternal, "a state of a delivery without a name");
}

void InsertDelivery(Connection& connection, const Delivery& delivery) {
  connection.Execute(
      "INSERT INTO deliveries (id, webhook, event, body, due_at, created_at) VALUES (?, ?, ?, ?, "
      "?, ?)",
      delivery.id, delivery.webhook, delivery.event, delivery.body, delivery.created_at,
      delivery.created_at);
  TrimWaiting(connection, delivery.webhook);
}

Delivery FindDelivery(Connection& connection, const std::string& id) {
  Statement query = connection.Query(kSelect + "WHERE id = ?", id);
  Require(query.Step(), ErrorCode::kNotFound, "there is no delivery '" + id + "'");
  return FromRow(query);
}

std::vector<Delivery> ListDeliveries(Connection& connection, const std::string& webhook,
                                     const Page& page) {
  return FromRows(connection.Query(
      kSelect + "WHERE webhook = ? AND sequence < ? ORDER BY sequence DESC LIMIT ?", webhook,
      page.before, page.limit));
}

std::vector<Delivery> DueDeliveries(Connection& connection, const std::string& now) {
  return FromRows(connection.Query(kSelect +
                                       R"(WHERE sequence IN (SELECT min(sequence) FROM deliveries
               WHERE state = 'waiting' AND due_at <= ? GROUP BY webhook) ORDER BY due_at)",
                                   now));
}

std::int64_t CountDeliveries(Connection& connection, DeliveryState state) {
  Statement query = connection.Query("SELECT count(*) FROM deliveries WHERE state = ?",
                                     std::string(ToText(state)));
  query.Step();
  return query.Integer(0);
}

void UpdateDelivery(Connection& connection, const Delivery& delivery) {
  connection.Execute(
      R"(UPDATE deliveries SET state = ?, attempts = ?, due_at = ?, status = ?, duration_ms = ?, error = ?,
                               finished_at = ? WHERE id = ? AND state = 'waiting')",
      std::string(ToText(delivery.state)), delivery.attempts, delivery.due_at, delivery.status,
      delivery.duration_ms, delivery.error, delivery.finished_at, delivery.id);
  if (delivery.state != DeliveryState::kWaiting) TrimLog(connection, delivery.webhook);
}

}  // namespace parkade

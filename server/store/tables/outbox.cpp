#include "server/store/tables/outbox.h"

#include <nlohmann/json.hpp>

#include "server/store/tables/names.h"
#include "server/store/tables/webhook_table.h"

namespace parkade {
namespace {

using OrderedJson = nlohmann::ordered_json;

template <typename Value>
OrderedJson ValueOrNull(const std::optional<Value>& value) {
  return value ? OrderedJson(*value) : OrderedJson(nullptr);
}

Delivery Enqueue(Connection& connection, const std::string& webhook, const std::string& event,
                 const OrderedJson& details) {
  Delivery delivery;
  delivery.id = NewId();
  delivery.webhook = webhook;
  delivery.event = event;
  delivery.created_at = NowUtc();
  OrderedJson body = {{"event", event}, {"created_at", delivery.created_at}};
  body.update(details);
  // A sentence may quote a user's file name, whose bytes may be anything.
  delivery.body = body.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  InsertDelivery(connection, delivery);
  return delivery;
}

void Tell(Connection& connection, const std::string& event, const std::string& site,
          const OrderedJson& details) {
  for (const Webhook& webhook : WebhooksFor(connection, event, site))
    Enqueue(connection, webhook.id, event, details);
}

}  // namespace

void NoteJobEnd(Connection& connection, const Job& job) {
  Tell(connection, "job", job.site,
       {{"site", job.site},
        {"job",
         {{"id", job.id},
          {"state", ToText(job.state)},
          {"drives", job.drives},
          {"error", ValueOrNull(job.error)},
          {"error_code", ValueOrNull(job.error_code)},
          {"map_version", ValueOrNull(job.map_version)},
          {"finished_at", ValueOrNull(job.finished_at)}}}});
}

void NotePublished(Connection& connection, const MapVersion& map) {
  Tell(connection, "published", map.site,
       {{"site", map.site}, {"version", map.version}, {"job", map.job}, {"sha256", map.sha256}});
}

void NoteReviewed(Connection& connection, const MapVersion& map, const ReviewEntry& entry) {
  Tell(connection, "reviewed", map.site,
       {{"site", map.site},
        {"version", map.version},
        {"action", entry.action},
        {"from", ToText(entry.from)},
        {"to", ToText(entry.to)},
        {"comment", entry.comment},
        {"author", entry.author}});
}

Delivery NoteTest(Connection& connection, const std::string& webhook) {
  return Enqueue(connection, webhook, "test", OrderedJson::object());
}

}  // namespace parkade

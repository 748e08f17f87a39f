#include "server/store/tables/webhook_table.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, id, url, events, site, secret, author, created_at FROM webhooks ";

Webhook FromRow(const Statement& row) {
  Webhook webhook;
  webhook.sequence = row.Integer(0);
  webhook.id = row.Text(1);
  webhook.url = row.Text(2);
  webhook.events = nlohmann::json::parse(row.Text(3)).get<std::vector<std::string>>();
  webhook.site = OptionalText(row, 4);
  webhook.secret = row.Text(5);
  webhook.author = row.Text(6);
  webhook.created_at = row.Text(7);
  return webhook;
}

std::vector<Webhook> FromRows(Statement query) {
  std::vector<Webhook> webhooks;
  while (query.Step()) webhooks.push_back(FromRow(query));
  return webhooks;
}

}  // namespace

void InsertWebhook(Connection& connection, const Webhook& webhook) {
  connection.Execute(
      "INSERT INTO webhooks (id, url, events, site, secret, author, created_at) VALUES (?, ?, ?, "
      "?, ?, ?, ?)",
      webhook.id, webhook.url, nlohmann::json(webhook.events).dump(), webhook.site, webhook.secret,
      webhook.author, webhook.created_at);
}

Webhook FindWebhook(Connection& connection, const std::string& id) {
  Statement query = connection.Query(kSelect + "WHERE id = ?", id);
  Require(query.Step(), ErrorCode::kNotFound, "there is no webhook '" + id + "'");
  return FromRow(query);
}

std::vector<Webhook> ListWebhooks(Connection& connection, const Page& page) {
  return FromRows(connection.Query(kSelect + "WHERE sequence < ? ORDER BY sequence DESC LIMIT ?",
                                   page.before, page.limit));
}

std::int64_t CountWebhooks(Connection& connection) {
  Statement query = connection.Query("SELECT count(*) FROM webhooks");
  query.Step();
  return query.Integer(0);
}

std::vector<Webhook> WebhooksFor(Connection& connection, const std::string& event,
                                 const std::string& site) {
  return FromRows(connection.Query(
      kSelect +
          "WHERE (site IS NULL OR site = ?) AND EXISTS (SELECT 1 FROM json_each(events) WHERE "
          "value = ?) ORDER BY sequence",
      site, event));
}

void DeleteWebhook(Connection& connection, const std::string& id) {
  connection.Execute("DELETE FROM webhooks WHERE id = ?", id);
}

}  // namespace parkade

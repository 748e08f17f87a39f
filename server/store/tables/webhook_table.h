#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

/// An address that is told of events.
struct Webhook {
  std::int64_t sequence = 0;
  std::string id;
  std::string url;
  std::vector<std::string> events;  ///< "job", "published", "reviewed"
  std::optional<std::string> site;  ///< only events of this one
  std::string secret;               ///< deliveries are signed with it
  std::string author;
  std::string created_at;
};

// Rows of `webhooks`.

void InsertWebhook(Connection& connection, const Webhook& webhook);

/// Throws Error{kNotFound}.
Webhook FindWebhook(Connection& connection, const std::string& id);

/// Newest first.
std::vector<Webhook> ListWebhooks(Connection& connection, const Page& page);
std::int64_t CountWebhooks(Connection& connection);

/// Those that are told of such an event of this site.
std::vector<Webhook> WebhooksFor(Connection& connection, const std::string& event,
                                 const std::string& site);

/// Its deliveries go with it.
void DeleteWebhook(Connection& connection, const std::string& id);

}  // namespace parkade

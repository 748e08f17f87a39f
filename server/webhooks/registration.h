#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/store.h"
#include "server/store/tables/webhook_table.h"

namespace parkade {

struct NewWebhook {
  std::string url;
  std::vector<std::string> events;
  std::optional<std::string> site;
};

/// Throws Error{kInvalidInput} unless deliveries could be sent there: an address of http or https
/// with a host, without a user, password or fragment. A host written as a number has to be public
/// unless `allow_private`; where names lead is checked at every connection.
void CheckWebhookUrl(const std::string& url, bool allow_private);

/// Keeps a webhook with a new secret. Durable when it returns. Throws Error{kInvalidInput} for
/// addresses, events and sites that are not to be had, Error{kConflict} where there are 100.
Webhook AddWebhook(Store& store, const NewWebhook& webhook, bool allow_private,
                   const std::string& author);

/// With the log of its deliveries, and what still waits. Throws Error{kNotFound}.
void RemoveWebhook(Store& store, const std::string& id);

}  // namespace parkade

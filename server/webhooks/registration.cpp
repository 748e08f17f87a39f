#include "server/webhooks/registration.h"

#include <arpa/inet.h>
#include <curl/curl.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <memory>

#include "core/error.h"
#include "server/store/access/audit_log.h"
#include "server/store/tables/names.h"
#include "server/store/tables/site_table.h"
#include "server/store/tables/text_rules.h"
#include "server/webhooks/address_check.h"

namespace parkade {
namespace {

constexpr size_t kMaxUrl = 2000;  // [bytes]
constexpr size_t kSecretBytes = 32;
// Each has one delivery under way at a time: this bounds the sender's memory and sockets.
constexpr std::int64_t kMaxWebhooks = 100;

const std::vector<std::string> kEvents = {"job", "published", "reviewed"};

struct FreeUrl {
  void operator()(CURLU* url) const { curl_url_cleanup(url); }
};
using Url = std::unique_ptr<CURLU, FreeUrl>;

/// "" where the address has no such part.
std::string PartOf(const Url& url, CURLUPart part) {
  char* text = nullptr;
  if (curl_url_get(url.get(), part, &text, 0) != CURLUE_OK) return "";
  std::string found = text;
  curl_free(text);
  return found;
}

/// True for hosts written as an address that is not public; curl takes 0x7f.1 for one, too, and
/// hands it out as 127.0.0.1.
bool IsPrivateNumber(std::string host) {
  sockaddr_in ipv4{};
  ipv4.sin_family = AF_INET;
  if (::inet_pton(AF_INET, host.c_str(), &ipv4.sin_addr) == 1)
    return !IsPublicAddress(reinterpret_cast<const sockaddr&>(ipv4));
  if (host.size() < 2 || host.front() != '[') return false;
  host = host.substr(1, host.size() - 2);
  sockaddr_in6 ipv6{};
  ipv6.sin6_family = AF_INET6;
  return ::inet_pton(AF_INET6, host.c_str(), &ipv6.sin6_addr) != 1 ||
         !IsPublicAddress(reinterpret_cast<const sockaddr&>(ipv6));
}

void CheckEvents(const std::vector<std::string>& events) {
  const auto is_known = [](const std::string& event) {
    return std::find(kEvents.begin(), kEvents.end(), event) != kEvents.end();
  };
  const auto is_twice = [&](const std::string& event) {
    return std::count(events.begin(), events.end(), event) > 1;
  };
  Require(!events.empty() && std::all_of(events.begin(), events.end(), is_known) &&
              std::none_of(events.begin(), events.end(), is_twice),
          ErrorCode::kInvalidInput, "\"events\" lists some of job, published and reviewed");
}

}  // namespace

void CheckWebhookUrl(const std::string& url, bool allow_private) {
  CheckText(url, {.name = "url", .max_bytes = kMaxUrl, .is_required = true});
  const Url parsed(curl_url());
  Require(parsed != nullptr, ErrorCode::kInternal, "no memory is left to read an address");
  const bool is_url = curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), 0) == CURLUE_OK;
  const std::string scheme = is_url ? PartOf(parsed, CURLUPART_SCHEME) : "";
  const std::string host = is_url ? PartOf(parsed, CURLUPART_HOST) : "";
  Require((scheme == "http" || scheme == "https") && !host.empty(), ErrorCode::kInvalidInput,
          "\"url\" is an address that begins with https:// or http://");
  for (const CURLUPart part : {CURLUPART_USER, CURLUPART_PASSWORD, CURLUPART_FRAGMENT})
    Require(PartOf(parsed, part).empty(), ErrorCode::kInvalidInput,
            "\"url\" has no user, password or fragment");
  Require(allow_private || !IsPrivateNumber(host), ErrorCode::kInvalidInput,
          "\"url\" leads to a private address, which this service does not send to: "
          "--webhook-private lets it");
}

Webhook AddWebhook(Store& store, const NewWebhook& added, bool allow_private,
                   const std::string& author) {
  CheckWebhookUrl(added.url, allow_private);
  CheckEvents(added.events);
  Webhook webhook;
  webhook.id = NewId();
  webhook.url = added.url;
  webhook.events = added.events;
  webhook.site = added.site;
  webhook.secret = HexOf(RandomBytes(kSecretBytes));
  webhook.author = author;
  webhook.created_at = NowUtc();
  store.database.Write([&](Connection& connection) {
    Require(!webhook.site || HasSite(connection, *webhook.site), ErrorCode::kInvalidInput,
            "there is no site '" + webhook.site.value_or("") + "'");
    Require(CountWebhooks(connection) < kMaxWebhooks, ErrorCode::kConflict,
            "there are " + std::to_string(kMaxWebhooks) + " webhooks: delete one first");
    InsertWebhook(connection, webhook);
    RecordAudit(connection, "webhook.create", webhook.id);
  });
  return webhook;
}

void RemoveWebhook(Store& store, const std::string& id) {
  WriteToMakeRoom(store, [&](Connection& connection) {
    FindWebhook(connection, id);
    DeleteWebhook(connection, id);
    RecordAudit(connection, "webhook.delete", id);
  });
}

}  // namespace parkade

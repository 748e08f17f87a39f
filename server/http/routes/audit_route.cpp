#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/store/access/audit_log.h"

namespace parkade {
namespace {

Json ToJson(const AuditEntry& entry) {
  const auto or_null = [](const std::string& text) { return text.empty() ? Json() : Json(text); };
  return {{"number", entry.sequence},
          {"at", entry.at},
          {"caller", {{"id", or_null(entry.caller_id)}, {"name", entry.caller_name}}},
          {"address", or_null(entry.address)},
          {"action", entry.action},
          {"subject", entry.subject},
          {"detail", entry.detail.empty() ? Json() : Json::parse(entry.detail)},
          {"sha256", entry.sha256}};
}

}  // namespace

void AddAuditRoute(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/audit",
            [&context](const httplib::Request& request, httplib::Response& response) {
              const Page page = PageOf(request);
              std::vector<AuditEntry> entries = context.store.database.Read(
                  [&](Connection& connection) { return ListAudit(connection, WithOneMore(page)); });
              response.set_header("Cache-Control", "no-store");
              SendPage(response, page, std::move(entries),
                       [](const AuditEntry& entry) { return ToJson(entry); });
            });
}

}  // namespace parkade

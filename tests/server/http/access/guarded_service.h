#pragma once

#include <map>
#include <string>

#include "server/store/access/shares.h"
#include "server/store/access/tokens.h"
#include "tests/server/http/running_service.h"

namespace parkade {

/// A service with tokens for everybody, by name: "admin", "viewer", "uploader", "reviewer" for all
/// sites; "viewer of other", ... for the site "other" alone; "revoked" and "expired" of an admin.
class GuardedService : public RunningService {
 protected:
  GuardedService() {
    const DataDirectory directory(options_.data);
    Database database(directory.DatabaseFile());
    options_.request_rate = 0;
    for (const Role role : {Role::kAdmin, Role::kViewer, Role::kUploader, Role::kReviewer}) {
      const std::string name = ToText(role);
      tokens_[name] = Made(database, name, role).secret;
      tokens_[name + " of other"] = Made(database, name + " of other", role, {{"other"}}).secret;
    }
    tokens_["second uploader"] = Made(database, "second uploader", Role::kUploader).secret;
    const NewToken revoked = Made(database, "revoked", Role::kAdmin);
    RevokeToken(database, revoked.token.id);
    tokens_["revoked"] = revoked.secret;
    const NewToken expired = Made(database, "expired", Role::kAdmin);
    database.Write([&](Connection& connection) {
      connection.Execute("UPDATE tokens SET expires_at = ? WHERE id = ?",
                         UtcIn(std::chrono::hours(-1)), expired.token.id);
    });
    tokens_["expired"] = expired.secret;
  }

  static NewToken Made(Database& database, const std::string& name, Role role,
                       const SiteScope& sites = {}) {
    Token token;
    token.name = name;
    token.role = role;
    token.sites = sites;
    return CreateToken(database, token);
  }

  static httplib::Headers Bearer(const std::string& secret) {
    return {{"Authorization", "Bearer " + secret}};
  }
  httplib::Headers As(const std::string& name) const { return Bearer(tokens_.at(name)); }

  /// From now on requests without other credentials are those of `name`.
  void Become(const std::string& name) { client().set_default_headers(As(name)); }

  httplib::Result Ask(const std::string& method, const std::string& path, httplib::Headers headers,
                      const std::string& body = "") {
    DescribedClient asker("127.0.0.1", (client(), service_->port()));
    asker.set_read_timeout(60);
    httplib::Request request;
    request.method = method;
    request.path = path;
    request.headers = std::move(headers);
    request.body = body;
    return asker.send(request);
  }
  httplib::Result Ask(const std::string& method, const std::string& path, const std::string& name,
                      const std::string& body = "") {
    return Ask(method, path, As(name), body);
  }

  std::map<std::string, std::string> tokens_;
};

}  // namespace parkade

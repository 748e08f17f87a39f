#pragma once

#include <httplib.h>

#include <optional>
#include <string>

#include "server/http/request_head.h"

namespace parkade {

/// What a request shows to say who it is from.
struct Credentials {
  std::optional<std::string> bearer;   ///< secret of a token or share link, by Authorization
  std::optional<std::string> session;  ///< secret of a session, by cookie
};

/// Throws HttpError{401} for an Authorization other than "Bearer SECRET".
Credentials CredentialsOf(const httplib::Request& request);

/// The secret that a request shows by its head, whatever it is of; nothing where it shows none.
std::optional<std::string> SecretIn(const RequestHead& head);

/// Sets the cookie of a session, that no page's script sees and no other site's request carries.
/// Behind a proxy that speaks TLS it never goes without.
void SetSessionCookie(const httplib::Request& request, const std::string& secret,
                      httplib::Response& response);
void ClearSessionCookie(const httplib::Request& request, httplib::Response& response);

}  // namespace parkade

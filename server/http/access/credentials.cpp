#include "server/http/access/credentials.h"

#include <strings.h>

#include <algorithm>
#include <string_view>

#include "server/http/problem.h"

namespace parkade {
namespace {

constexpr std::string_view kScheme = "Bearer ";

/// What a proxy says that took the request by TLS. A client that says so itself makes its own
/// cookie useless.
bool IsOverTls(const httplib::Request& request) {
  return request.get_header_value("X-Forwarded-Proto") == "https";
}

/// The prefix makes browsers refuse such a cookie where another host of the domain sets it.
std::string CookieName(bool is_over_tls) { return is_over_tls ? "__Host-parkade" : "parkade"; }

/// The secret of an Authorization "Bearer SECRET"; nothing for another.
std::optional<std::string> FindBearer(const std::string& authorization) {
  if (::strncasecmp(authorization.c_str(), kScheme.data(), kScheme.size()) != 0)
    return std::nullopt;
  return authorization.substr(kScheme.size());
}

std::optional<std::string> FindCookie(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view cookie = cookies.substr(0, end);
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
    while (cookie.starts_with(' ')) cookie.remove_prefix(1);
    if (cookie.starts_with(name) && cookie.substr(name.size()).starts_with('='))
      return std::string(cookie.substr(name.size() + 1));
  }
  return std::nullopt;
}

void SendCookie(const httplib::Request& request, const std::string& value,
                const std::string& attributes, httplib::Response& response) {
  const bool is_over_tls = IsOverTls(request);
  response.set_header("Set-Cookie", CookieName(is_over_tls) + "=" + value +
                                        "; Path=/; HttpOnly; SameSite=Strict" + attributes +
                                        (is_over_tls ? "; Secure" : ""));
}

}  // namespace

Credentials CredentialsOf(const httplib::Request& request) {
  Credentials credentials;
  if (request.has_header("Authorization")) {
    credentials.bearer = FindBearer(request.get_header_value("Authorization"));
    if (!credentials.bearer)
      throw HttpError({401, "unauthenticated", "say who you are by 'Authorization: Bearer TOKEN'"});
    return credentials;
  }
  credentials.session =
      FindCookie(request.get_header_value("Cookie"), CookieName(IsOverTls(request)));
  return credentials;
}

std::optional<std::string> SecretIn(const RequestHead& head) {
  if (const auto authorization = head.Find("authorization")) return FindBearer(*authorization);
  return FindCookie(head.Find("cookie").value_or(""),
                    CookieName(head.Find("x-forwarded-proto") == "https"));
}

void SetSessionCookie(const httplib::Request& request, const std::string& secret,
                      httplib::Response& response) {
  SendCookie(request, secret, "; Max-Age=43200", response);
}

void ClearSessionCookie(const httplib::Request& request, httplib::Response& response) {
  SendCookie(request, "", "; Max-Age=0", response);
}

}  // namespace parkade

#include "server/http/access/gate.h"

#include <openssl/crypto.h>

#include <chrono>

#include "core/error.h"
#include "core/log.h"
#include "server/http/access/rights.h"
#include "server/http/access/subject.h"
#include "server/http/problem.h"
#include "server/store/access/sessions.h"
#include "server/store/access/tokens.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

// Ten failures a minute and address.
constexpr double kFailuresPerSecond = 1.0 / 6;
constexpr double kFailuresAtOnce = 10;
constexpr double kBurst = 10;  // [s] of requests that may come at once
constexpr auto kUseIsNotedEvery = 1h;

[[noreturn]] void ThrowUnauthenticated(httplib::Response& response, const std::string& sentence) {
  response.set_header("WWW-Authenticate", "Bearer");
  throw HttpError({401, "unauthenticated", sentence});
}

[[noreturn]] void ThrowTooMany(httplib::Response& response, int seconds) {
  response.set_header("Retry-After", std::to_string(seconds));
  throw HttpError({429, "too_many_requests",
                   "too many requests: try again in " + std::to_string(seconds) + " seconds"});
}

[[noreturn]] void ThrowForbidden(const std::string& sentence) {
  throw HttpError({403, "forbidden", sentence});
}

bool IsEqual(const std::string& a, const std::string& b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

/// A page of another site can make a browser send the cookie, but cannot know this token.
void CheckCsrf(const httplib::Request& request, const std::string& session) {
  if (request.method == "GET" || request.method == "HEAD" || request.method == "OPTIONS") return;
  if (!IsEqual(request.get_header_value("X-CSRF-Token"), CsrfTokenOf(session)))
    throw HttpError({403, "csrf", "a change by a session needs its 'X-CSRF-Token'"});
}

/// What the caller may not know of answers as what does not exist.
void CheckSubject(const Caller& caller, const Route& route, const Subject& subject) {
  const bool is_own = !caller.id.empty() && subject.created_by == caller.id;
  const bool is_known = subject.site ? Includes(caller.sites, *subject.site) : !caller.sites;
  Require(is_known || (is_own && !subject.site), ErrorCode::kNotFound,
          "there is no " + subject.what + " '" + subject.id + "'");
  if (!is_own && NeedsToOwn(caller, route.right))
    ThrowForbidden("an uploader changes only what it uploaded itself");
}

}  // namespace

Gate::Gate(Database& database, int requests_per_second)
    : database_(database),
      failures_(kFailuresPerSecond, kFailuresAtOnce),
      requests_(requests_per_second, kBurst * requests_per_second),
      has_limit_(requests_per_second > 0) {
  IsOpen();
}

bool Gate::IsOpen() {
  if (is_open_) is_open_ = !database_.Read(HasTokens);
  return is_open_;
}

Caller Gate::LetIn(std::optional<Caller> caller, const char* otherwise,
                   const httplib::Request& request, httplib::Response& response) {
  const std::string address = request.remote_addr;
  if (caller) {
    caller->address = address;
    return *caller;
  }
  if (const int seconds = failures_.Take(address, RateLimiter::Clock::now()))
    ThrowTooMany(response, seconds);
  LogWarning("credentials refused address=" + address);
  ThrowUnauthenticated(response, otherwise);
}

Caller Gate::Authenticate(const std::string& secret, const httplib::Request& request,
                          httplib::Response& response) {
  std::optional<Caller> caller =
      database_.Read([&](Connection& connection) { return CallerOfSecret(connection, secret); });
  Caller known = LetIn(std::move(caller), "this token is unknown, was revoked or has expired",
                       request, response);
  // Links are handed on to whoever is to see a map: who comes by one is no identity of ours.
  if (!known.has_link_only) known_.Note(secret);
  return known;
}

std::optional<Caller> Gate::Identify(const httplib::Request& request, httplib::Response& response) {
  if (IsOpen()) return LetIn(CallerWithAllRights("local"), "", request, response);
  const Credentials credentials = CredentialsOf(request);
  if (credentials.bearer) return Authenticate(*credentials.bearer, request, response);
  if (!credentials.session) return std::nullopt;
  const Caller caller = LetIn(CallerOfSession(database_, *credentials.session),
                              "the session is over: sign in again", request, response);
  if (!caller.has_link_only) known_.Note(*credentials.session);
  CheckCsrf(request, *credentials.session);
  return caller;
}

Caller Gate::Admit(const Route& route, const httplib::Request& request,
                   httplib::Response& response) {
  if (route.right == Right::kNone) {
    Caller nobody;
    nobody.name = "nobody";
    nobody.address = request.remote_addr;
    return nobody;
  }
  const std::optional<Caller> caller = Identify(request, response);
  if (!caller) ThrowUnauthenticated(response, "this needs a token: 'Authorization: Bearer TOKEN'");
  if (caller->id.empty()) return *caller;  // the service is open
  if (has_limit_)
    if (const int seconds = requests_.Take(caller->id, RateLimiter::Clock::now()))
      ThrowTooMany(response, seconds);
  if (!HasRight(*caller, route.right)) ThrowForbidden(NeedOf(route.right));
  if (route.reach == Reach::kWhole && caller->sites)
    ThrowForbidden("this concerns all sites, and your token is for some of them");
  if (const auto subject = SubjectOf(route, request, database_))
    CheckSubject(*caller, route, *subject);
  if (const auto version = VersionOf(route, request)) {
    const WorkFor scope(*caller);
    RequireVersion(*version);
  }
  NoteUse(*caller);
  return *caller;
}

void Gate::NoteUse(const Caller& caller) {
  if (caller.has_link_only || database_.is_frozen()) return;
  {
    const RateLimiter::Clock::time_point now = RateLimiter::Clock::now();
    const std::lock_guard lock(mutex_);
    const auto [noted, is_first] = noted_.try_emplace(caller.id, now);
    if (!is_first && now - noted->second < kUseIsNotedEvery) return;
    noted->second = now;
  }
  try {
    database_.Write([&](Connection& connection) { SetTokenUsed(connection, caller.id, NowUtc()); });
  } catch (const Error& error) {
    LogWarning(std::string("use of a token not noted: ") + error.what());  // a full disk
  }
}

void RequireSite(const std::optional<std::string>& site) {
  const Caller& caller = CurrentCaller();
  if (!caller.sites || (site && Includes(caller.sites, *site))) return;
  std::string names;
  for (const std::string& name : *caller.sites) names += (names.empty() ? "'" : ", '") + name + "'";
  ThrowForbidden("name a site that your token is for: " + names);
}

void RequireVersion(std::int64_t version) {
  const Caller& caller = CurrentCaller();
  if (!caller.version || *caller.version == version) return;
  throw Error(ErrorCode::kNotFound,
              "your link does not lead to version " + std::to_string(version));
}

}  // namespace parkade

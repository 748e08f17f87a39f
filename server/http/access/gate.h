#pragma once

#include <httplib.h>

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "server/http/access/credentials.h"
#include "server/http/access/known_callers.h"
#include "server/http/access/rate_limiter.h"
#include "server/http/route_table.h"
#include "server/store/access/caller.h"
#include "server/store/tables/database.h"

namespace parkade {

/// Decides who gets to which route. While no token was ever made, everybody may do everything: the
/// service listens on loopback then. Thread-safe.
class Gate {
 public:
  /// Callers may ask `requests_per_second` each in the long run, ten times as often for a moment;
  /// 0: as often as they like.
  Gate(Database& database, int requests_per_second);

  /// The one who asks, where that one may. Throws HttpError: 401 who are you, 403 not you, 404 what
  /// the caller may not know of, 429 not so fast.
  Caller Admit(const Route& route, const httplib::Request& request, httplib::Response& response);

  /// Who asks, by what the request shows; nothing where it shows nothing. Throws HttpError{401,
  /// 429} where that lets nobody in.
  std::optional<Caller> Identify(const httplib::Request& request, httplib::Response& response);

  /// The caller whose token or share link `secret` is. Throws HttpError{401, 429}.
  Caller Authenticate(const std::string& secret, const httplib::Request& request,
                      httplib::Response& response);

  /// True where a request comes from somebody who was let in lately, or from anybody while the gate
  /// is open. By its head alone; waits for nobody.
  bool IsKnown(const RequestHead& head) const { return is_open_ || known_.Knows(head); }

  /// True as long as nobody needs a token.
  bool IsOpen();
  /// As IsOpen was answered last: waits for nobody.
  bool was_open() const { return is_open_; }

 private:
  /// The caller with its address, or else a failure of that address, with a sentence.
  Caller LetIn(std::optional<Caller> caller, const char* otherwise, const httplib::Request& request,
               httplib::Response& response);
  void NoteUse(const Caller& caller);

  Database& database_;
  KnownCallers known_;
  RateLimiter failures_, requests_;
  const bool has_limit_;
  std::atomic<bool> is_open_ = true;
  std::mutex mutex_;
  std::map<std::string, RateLimiter::Clock::time_point> noted_;  ///< uses, by token
};

/// Throws HttpError{403} unless the current caller may know of `site`; the site of something new
/// has to be named by those who may know of some only.
void RequireSite(const std::optional<std::string>& site);

/// Throws Error{kNotFound} unless the current caller may see that version of its site.
void RequireVersion(std::int64_t version);

}  // namespace parkade

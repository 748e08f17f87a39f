#pragma once

#include <array>
#include <memory>

#include "server/http/request_pool.h"

namespace parkade {

/// A pool for each class of requests, so that a full one stops no other.
class RequestPools {
 public:
  /// A quarter of `num_threads` (at least 4) answers the API, half serves listeners to events, four
  /// times as many take uploads, eight times as many send files; two answer whoever watches the
  /// service. A quarter of each, but for the last, is for those who are known.
  RequestPools(int num_threads, PoolHooks hooks, Metrics& metrics);

  /// Hands a connection whose request has begun to the pool of its class. Where that is full, the
  /// client is told at once to come back later, and the connection stays with the caller, to be
  /// closed. True when it was taken.
  bool Submit(std::unique_ptr<HttpConnection>& connection);

  void Relieve(HttpConnection::Clock::time_point now);
  bool IsIdle() const;
  void Join();

 private:
  const PoolHooks hooks_;
  Metrics& metrics_;
  std::array<std::unique_ptr<RequestPool>, kRouteClasses.size()> pools_;
};

}  // namespace parkade

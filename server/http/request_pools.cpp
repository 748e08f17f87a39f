#include "server/http/request_pools.h"

#include <algorithm>
#include <string>

namespace parkade {
namespace {

/// A quarter of it is kept for those who are known.
PoolSize WithReserve(size_t num_threads, size_t num_places) {
  return {num_threads, num_places, num_threads / 4, num_places / 4};
}

PoolSize SizeOf(RouteClass route_class, size_t num_threads) {
  switch (route_class) {
    case RouteClass::kHealth: return {2, 256};  // asked by machines that know nobody
    case RouteClass::kApi: return WithReserve(num_threads / 4, 256);
    // Their threads do little but wait for clients, and start only where there are as many.
    case RouteClass::kUploads: return WithReserve(num_threads * 4, 64);
    case RouteClass::kDownloads: return WithReserve(num_threads * 8, 256);
    case RouteClass::kEvents: return WithReserve(num_threads / 2, 0);  // nobody leaves soon
  }
  return {};
}

/// [s] until one that was refused comes back.
int RetryAfter(RouteClass route_class) {
  switch (route_class) {
    case RouteClass::kUploads: return 5;
    case RouteClass::kDownloads: return 2;
    case RouteClass::kEvents: return 10;
    default: return 1;
  }
}

}  // namespace

RequestPools::RequestPools(int num_threads, PoolHooks hooks, Metrics& metrics)
    : hooks_(std::move(hooks)), metrics_(metrics) {
  for (const RouteClass route_class : kRouteClasses) {
    pools_[static_cast<size_t>(route_class)] = std::make_unique<RequestPool>(
        SizeOf(route_class, static_cast<size_t>(num_threads)), hooks_, metrics.of(route_class));
  }
}

bool RequestPools::Submit(std::unique_ptr<HttpConnection>& connection) {
  const RouteClass route_class = connection->route_class();
  if (pools_[static_cast<size_t>(route_class)]->Submit(connection)) return true;
  ++metrics_.of(route_class).refused;
  connection->SendProblem({503, "busy",
                           std::string("too many requests of this kind (") + NameOf(route_class) +
                               ") at a time: try again in a moment"},
                          RetryAfter(route_class));
  return false;
}

void RequestPools::Relieve(HttpConnection::Clock::time_point now) {
  for (const auto& pool : pools_) pool->Relieve(now);
}

bool RequestPools::IsIdle() const {
  return std::all_of(pools_.begin(), pools_.end(), [](const auto& pool) { return pool->IsIdle(); });
}

void RequestPools::Join() {
  for (const auto& pool : pools_) pool->Join();
}

}  // namespace parkade

#include "server/http/request_pools.h"

#include <algorithm>
#include <string>

namespace parkade {
namespace {

struct PoolSize {
  size_t num_threads = 0, num_waiting = 0;
  int retry_after = 1;  ///< [s]
};

PoolSize SizeOf(RouteClass route_class, size_t num_threads) {
  switch (route_class) {
    case RouteClass::kHealth: return {2, 256, 1};
    case RouteClass::kApi: return {num_threads / 4, 256, 1};
    // Their threads do little but wait for clients, and start only where there are as many.
    case RouteClass::kUploads: return {num_threads * 4, 64, 5};
    case RouteClass::kDownloads: return {num_threads * 8, 256, 2};
    case RouteClass::kEvents: return {num_threads / 2, 0, 10};  // nobody leaves soon
  }
  return {};
}

}  // namespace

RequestPools::RequestPools(int num_threads, PoolHooks hooks, Metrics& metrics)
    : hooks_(std::move(hooks)), metrics_(metrics) {
  for (const RouteClass route_class : kRouteClasses) {
    const PoolSize size = SizeOf(route_class, static_cast<size_t>(num_threads));
    pools_[static_cast<size_t>(route_class)] = std::make_unique<RequestPool>(
        size.num_threads, size.num_waiting, hooks_, metrics.of(route_class));
  }
}

bool RequestPools::Submit(std::unique_ptr<HttpConnection>& connection) {
  const RouteClass route_class = connection->route_class();
  if (pools_[static_cast<size_t>(route_class)]->Submit(connection)) return true;
  ++metrics_.of(route_class).refused;
  connection->SendProblem({503, "busy",
                           std::string("too many requests of this kind (") + NameOf(route_class) +
                               ") at a time: try again in a moment"},
                          SizeOf(route_class, 0).retry_after);
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

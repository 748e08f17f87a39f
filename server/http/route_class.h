#pragma once

#include <array>
#include <string_view>

namespace parkade {

/// What a request asks of the service. Each class has threads of its own (RequestPools), so that
/// one whose threads are all taken holds up no other.
enum class RouteClass {
  kHealth,     ///< asked by whoever watches the service: always answered
  kApi,        ///< short answers out of the database
  kUploads,    ///< bodies that come as fast as the client sends
  kDownloads,  ///< answers that go as fast as the client reads
  kEvents,     ///< streams that last for minutes
};

inline constexpr std::array kRouteClasses = {RouteClass::kHealth, RouteClass::kApi,
                                             RouteClass::kUploads, RouteClass::kDownloads,
                                             RouteClass::kEvents};

/// "health", "api", ...
const char* NameOf(RouteClass route_class);

}  // namespace parkade

#pragma once

#include <httplib.h>

#include <functional>
#include <type_traits>
#include <utility>

#include "server/http/access/gate.h"
#include "server/http/route_table.h"

namespace parkade {

/// Adds handlers to the HTTP library, each behind the gate with the right that its row of kRoutes
/// asks for. Groups of the path's parameters are `matches` of the request, in their order.
class Router {
 public:
  Router(httplib::Server& http, Gate& gate) : http_(http), gate_(gate) {}

  /// `handler` takes a request and a response, and the reader of the body where it wants the body.
  template <typename Handler>
  void On(RouteName name, Handler handler) {
    if constexpr (std::is_invocable_v<Handler, const httplib::Request&, httplib::Response&>) {
      Add(name.route(), [handler = std::move(handler)](
                            const httplib::Request& request, httplib::Response& response,
                            const httplib::ContentReader*) { handler(request, response); });
    } else {
      Add(name.route(),
          [handler = std::move(handler)](
              const httplib::Request& request, httplib::Response& response,
              const httplib::ContentReader* body) { handler(request, response, *body); });
    }
  }

 private:
  /// `body` is null for methods without one.
  using AnyHandler = std::function<void(const httplib::Request&, httplib::Response&,
                                        const httplib::ContentReader* body)>;

  void Add(const Route& route, AnyHandler handler);

  httplib::Server& http_;
  Gate& gate_;
};

}  // namespace parkade

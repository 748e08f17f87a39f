#pragma once

#include <httplib.h>

#include "server/http/route_table.h"
#include "server/store/access/caller.h"

namespace parkade {

/// Decides who gets to which route.
class Gate {
 public:
  /// The one who asks, where that one may. Throws HttpError otherwise.
  Caller Admit(const Route& route, const httplib::Request& request, httplib::Response& response);
};

}  // namespace parkade

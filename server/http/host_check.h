#pragma once

#include "server/http/request_head.h"

namespace parkade {

/// Refuses a request whose Host is neither "localhost" nor a loopback address, whatever the port.
/// For a service that listens on loopback: whoever owns a name can have it lead here, and then
/// browsers take his page for the service's own (DNS rebinding). Only the Host tells. A request of
/// HTTP/1.0 without a Host is let in: no browser sends one. Throws HttpError{403}.
void RefuseForeignHost(const RequestHead& head);

}  // namespace parkade

#pragma once

#include <string>

#include "server/http/request_head.h"

namespace parkade {

/// Refuses a request whose Host is neither "localhost", a loopback address nor the name of a proxy
/// on this machine, whatever the port.
/// For a service that listens on loopback: whoever owns a name can have it lead here, and then
/// browsers take his page for the service's own (DNS rebinding). Only the Host tells. A request of
/// HTTP/1.0 without a Host is let in: no browser sends one. Throws HttpError{403}.
void RefuseForeignHost(const RequestHead& head, const std::string& proxy_host);

/// True for a Host field "NAME" or "NAME:PORT" of this name, in any case; never for an empty name.
bool NamesHost(const std::string& host_field, const std::string& name);

}  // namespace parkade

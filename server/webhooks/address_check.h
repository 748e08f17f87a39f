#pragma once

struct sockaddr;

namespace parkade {

/// False for addresses that lead to this machine or its networks, or nowhere: loopback, private,
/// link-local, shared, multicast, reserved ones, and IPv6 addresses that stand for such an IPv4
/// address. Other families than IPv4 and IPv6 are not public.
bool IsPublicAddress(const sockaddr& address);

}  // namespace parkade

#include "server/http/listen_address.h"

#include <arpa/inet.h>

#include <charconv>

#include "core/error.h"

namespace parkade {

ListenAddress ParseListenAddress(const std::string& text) {
  const std::string wrong = "'" + text + "' is not an address of the form HOST:PORT";
  const size_t colon = text.rfind(':');
  Require(colon != std::string::npos && colon > 0, ErrorCode::kUsage, wrong);
  ListenAddress address;
  address.host = text.substr(0, colon);
  if (address.host.starts_with('[') && address.host.ends_with(']'))
    address.host = address.host.substr(1, address.host.size() - 2);
  else
    Require(address.host.find(':') == std::string::npos, ErrorCode::kUsage, wrong);
  const char *begin = text.data() + colon + 1, *end = text.data() + text.size();
  const auto parsed = std::from_chars(begin, end, address.port);
  const bool is_port =
      begin != end && parsed.ec == std::errc{} && parsed.ptr == end && address.port >= 0;
  Require(is_port && address.port <= 65535 && !address.host.empty(), ErrorCode::kUsage, wrong);
  return address;
}

bool IsLoopback(const std::string& host) {
  in_addr ipv4{};
  if (inet_pton(AF_INET, host.c_str(), &ipv4) == 1) return (ntohl(ipv4.s_addr) >> 24) == 127;
  in6_addr ipv6{};
  if (inet_pton(AF_INET6, host.c_str(), &ipv6) == 1) return IN6_IS_ADDR_LOOPBACK(&ipv6);
  return host == "localhost";
}

}  // namespace parkade

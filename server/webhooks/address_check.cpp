#include "server/webhooks/address_check.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace parkade {
namespace {

using Ipv6 = std::array<std::uint8_t, 16>;

struct Ipv4Block {
  std::uint32_t network;
  int bits;
};

// IANA's special-purpose blocks.
constexpr std::array kIpv4Blocks = {
    Ipv4Block{0x00000000, 8},   // "this" network
    Ipv4Block{0x0a000000, 8},   // private
    Ipv4Block{0x64400000, 10},  // shared by carriers
    Ipv4Block{0x7f000000, 8},   // loopback
    Ipv4Block{0xa9fe0000, 16},  // link-local; clouds' metadata
    Ipv4Block{0xac100000, 12},  // private
    Ipv4Block{0xc0000000, 24},  // protocol assignments
    Ipv4Block{0xc0000200, 24},  // documentation
    Ipv4Block{0xc0586300, 24},  // relays from IPv6
    Ipv4Block{0xc0a80000, 16},  // private
    Ipv4Block{0xc6120000, 15},  // benchmarks
    Ipv4Block{0xc6336400, 24},  // documentation
    Ipv4Block{0xcb007100, 24},  // documentation
    Ipv4Block{0xe0000000, 4},   // multicast
    Ipv4Block{0xf0000000, 4},   // reserved, broadcast
};

bool IsPublicIpv4(std::uint32_t address) {
  return std::none_of(kIpv4Blocks.begin(), kIpv4Blocks.end(), [&](const Ipv4Block& block) {
    return (address ^ block.network) >> (32 - block.bits) == 0;
  });
}

std::uint32_t Ipv4At(const Ipv6& address, size_t byte) {
  std::uint32_t found = 0;
  for (size_t i = 0; i < 4; ++i) found = found << 8 | address[byte + i];
  return found;
}

bool IsPublicIpv6(const Ipv6& address) {
  constexpr Ipv6 kMapped = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  if (std::equal(address.begin(), address.begin() + 12, kMapped.begin()))
    return IsPublicIpv4(Ipv4At(address, 12));
  constexpr std::array<std::uint8_t, 12> kTranslated = {0x00, 0x64, 0xff, 0x9b};
  if (std::equal(kTranslated.begin(), kTranslated.end(), address.begin()))
    return IsPublicIpv4(Ipv4At(address, 12));
  if (address[0] == 0x20 && address[1] == 0x02) return IsPublicIpv4(Ipv4At(address, 2));  // 6to4
  const bool is_special =
      address[0] == 0x20 && address[1] == 0x01 && address[2] < 0x02;  // Teredo, ORCHID, ...
  const bool is_documentation =
      address[0] == 0x20 && address[1] == 0x01 && address[2] == 0x0d && address[3] == 0xb8;
  const bool is_global = address[0] >> 5 == 1;  // 2000::/3, all that is given out
  return is_global && !is_special && !is_documentation;
}

}  // namespace

bool IsPublicAddress(const sockaddr& address) {
  if (address.sa_family == AF_INET) {
    sockaddr_in found{};
    std::memcpy(&found, &address, sizeof(found));
    return IsPublicIpv4(ntohl(found.sin_addr.s_addr));
  }
  if (address.sa_family != AF_INET6) return false;
  sockaddr_in6 found{};
  std::memcpy(&found, &address, sizeof(found));
  Ipv6 bytes{};
  std::memcpy(bytes.data(), &found.sin6_addr, bytes.size());
  return IsPublicIpv6(bytes);
}

}  // namespace parkade

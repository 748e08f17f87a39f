#include "server/http/trace/request_trace.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>

#include "core/log.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

constexpr size_t kMaxIdLength = 64;

std::atomic<bool> is_access_logged = false;

bool IsIdCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
}

}  // namespace

std::string RequestIdFrom(const std::optional<std::string>& field) {
  const bool is_sane = field && !field->empty() && field->size() <= kMaxIdLength &&
                       std::all_of(field->begin(), field->end(), IsIdCharacter);
  return is_sane ? *field : NewId();
}

std::optional<std::string> ClientAddressFrom(const std::optional<std::string>& field) {
  if (!field) return std::nullopt;
  std::array<unsigned char, sizeof(in6_addr)> address{};
  std::array<char, INET6_ADDRSTRLEN> text{};
  const int family = field->find(':') == std::string::npos ? AF_INET : AF_INET6;
  if (::inet_pton(family, field->c_str(), address.data()) != 1) return std::nullopt;
  ::inet_ntop(family, address.data(), text.data(), text.size());
  return text.data();
}

void SetAccessLog(bool is_on) { is_access_logged = is_on; }

void LogAccess(const RequestTrace& trace, const AccessFigures& figures) {
  if (!is_access_logged) return;
  Log(LogLevel::kInfo, "request",
      {{"method", trace.method},
       {"path", trace.path},
       {"status", trace.status},
       {"class", figures.route_class},
       {"bytes_in", figures.bytes_in},
       {"bytes_out", figures.bytes_out},
       {"ms", figures.duration.count()},
       {"client", trace.client},
       {"request", trace.id}});
}

}  // namespace parkade

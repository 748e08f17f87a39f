#include "server/http/host_check.h"

#include "server/http/listen_address.h"

namespace parkade {
namespace {

/// "Name:80" -> "name", "[::1]" -> "::1"; "" where the text is not a host.
std::string HostWithoutPort(const std::string& text) {
  const bool is_bracketed = text.starts_with('[');
  const size_t end = is_bracketed ? text.find(']') : text.find(':');
  if (is_bracketed && end == std::string::npos) return "";
  const std::string port =
      end == std::string::npos ? "" : text.substr(end + (is_bracketed ? 1 : 0));
  if (!port.empty() &&
      (port.front() != ':' || port.find_first_not_of("0123456789", 1) != std::string::npos))
    return "";
  std::string host = is_bracketed ? text.substr(1, end - 1) : text.substr(0, end);
  for (char& c : host) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return host;
}

}  // namespace

void RefuseForeignHost(const RequestHead& head, const std::string& proxy_host) {
  const std::optional<std::string> host = head.Find("host");
  if (host && !IsLoopback(HostWithoutPort(*host)) && !NamesHost(*host, proxy_host))
    throw HttpError(
        {403, "foreign_host",
         "this service answers to 'localhost' and loopback addresses only, unless started with "
         "--proxy-host or --allow-public"});
}

bool NamesHost(const std::string& host_field, const std::string& name) {
  return !name.empty() && HostWithoutPort(host_field) == HostWithoutPort(name);
}

}  // namespace parkade

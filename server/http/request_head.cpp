#include "server/http/request_head.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "server/http/route_table.h"

namespace parkade {
namespace {

constexpr std::int64_t kMaxSmallBody = std::int64_t{16} << 20;

[[noreturn]] void Refuse(int status, const std::string& detail) {
  throw HttpError({status, status == 413 ? "too_large" : "invalid_request", detail});
}

bool IsTokenCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

bool IsToken(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), IsTokenCharacter);
}

bool IsControl(unsigned char byte) { return (byte < 0x20 && byte != '\t') || byte == 0x7f; }

/// True for control bytes, plain or written as %00 to %1f and %7f: the library decodes these in
/// values.
bool HasControlByte(std::string_view text) {
  for (size_t i = 0; i < text.size(); ++i) {
    if (IsControl(static_cast<unsigned char>(text[i]))) return true;
    if (text[i] != '%' || i + 2 >= text.size()) continue;
    unsigned int byte = 0;
    const char* digits = text.data() + i + 1;
    const auto parsed = std::from_chars(digits, digits + 2, byte, 16);
    if (parsed.ptr == digits + 2 && (byte < 0x20 || byte == 0x7f)) return true;
  }
  return false;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string InLowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Actions that have nothing to say but their address: `curl -X POST` sends no length.
bool NeedsNoBody(const RequestHead& head) {
  const std::string path = head.Path();
  return head.method == "POST" && (path.ends_with("/cancel") || path.ends_with("/retry") ||
                                   path.ends_with("/maps") || path == "/api/v1/uploads");
}

std::int64_t ContentLengthOf(const RequestHead& head) {
  const std::optional<std::string> text = head.Find("content-length");
  const bool may_have_body =
      head.method == "POST" || head.method == "PUT" || head.method == "PATCH";
  if (!text) {
    if (may_have_body && !NeedsNoBody(head)) Refuse(411, "the request needs a Content-Length");
    return 0;
  }
  std::int64_t length = -1;
  const auto parsed = std::from_chars(text->data(), text->data() + text->size(), length);
  if (text->empty() || parsed.ec != std::errc{} || parsed.ptr != text->data() + text->size() ||
      length < 0)
    Refuse(400, "the Content-Length is not a number");
  if (length > kMaxSmallBody && !RouteOf(head.method, head.Path()).has_large_body)
    Refuse(413, "the body is larger than 16 MiB");
  if (!may_have_body && length > 0) Refuse(400, "a " + head.method + " request has no body");
  return length;
}

/// A web page elsewhere may make a browser send requests here. Browsers say where
/// they come from; other programs do not.
void RefuseForeignChange(const RequestHead& head) {
  if (head.method == "GET" || head.method == "HEAD" || head.method == "OPTIONS") return;
  const std::optional<std::string> fetch_site = head.Find("sec-fetch-site");
  const bool is_foreign_fetch = fetch_site && *fetch_site != "same-origin" && *fetch_site != "none";
  const std::optional<std::string> origin = head.Find("origin");
  const std::string host = head.Find("host").value_or("");
  const bool is_foreign_origin =
      origin && *origin != "http://" + host && *origin != "https://" + host;
  if (is_foreign_fetch || is_foreign_origin)
    throw HttpError({403, "foreign_origin",
                     "requests that change something must come from this service's own page"});
}

/// Takes the host out of a target that names it, "http://HOST/PATH", as RFC 9112 (3.2.2) asks for:
/// it replaces the Host field.
void SplitAbsoluteTarget(RequestHead& head) {
  constexpr std::string_view kScheme = "http://";
  if (InLowerCase(head.target.substr(0, kScheme.size())) != kScheme) return;
  const size_t end = std::min(head.target.find_first_of("/?", kScheme.size()), head.target.size());
  const std::string host = head.target.substr(kScheme.size(), end - kScheme.size());
  if (host.empty() || host.find('@') != std::string::npos)
    Refuse(400, "the request line is malformed");
  head.target.erase(0, end);
  if (!head.target.starts_with('/')) head.target.insert(0, "/");
  for (auto& [field, value] : head.fields)
    if (field == "host") value = host;
}

}  // namespace

std::optional<std::string> RequestHead::Find(std::string_view name) const {
  for (const auto& [field, value] : fields)
    if (field == name) return value;
  return std::nullopt;
}

RequestHead ParseRequestHead(std::string_view text) {
  const auto next_line = [&text] {
    const size_t end = text.find("\r\n");
    if (end == std::string_view::npos) Refuse(400, "the request's lines do not end with CR LF");
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 2);
    return line;
  };

  RequestHead head;
  const std::string_view line = next_line();
  const size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || first == last)
    Refuse(400, "the request line is malformed");
  head.method = line.substr(0, first);
  head.target = line.substr(first + 1, last - first - 1);
  head.version = line.substr(last + 1);
  if (!IsToken(head.method) || head.target.find(' ') != std::string::npos ||
      HasControlByte(head.target))
    Refuse(400, "the request line is malformed");
  if (head.version != "HTTP/1.1" && head.version != "HTTP/1.0")
    Refuse(505, "this service speaks HTTP/1.1");

  for (std::string_view field = next_line(); !field.empty(); field = next_line()) {
    const size_t colon = field.find(':');
    if (colon == std::string_view::npos || !IsToken(field.substr(0, colon)))
      Refuse(400, "a header field is malformed");
    const std::string_view value = Trimmed(field.substr(colon + 1));
    if (HasControlByte(value)) Refuse(400, "a header field holds control characters");
    head.fields.emplace_back(InLowerCase(field.substr(0, colon)), value);
  }
  SplitAbsoluteTarget(head);
  if (!head.target.starts_with('/')) Refuse(400, "the request line is malformed");
  return head;
}

std::int64_t CheckRequestHead(const RequestHead& head) {
  constexpr std::array<std::string_view, 8> kOnce = {"content-length", "host",         "range",
                                                     "if-range",       "content-type", "origin",
                                                     "expect",         "last-event-id"};
  for (const std::string_view name : kOnce) {
    const auto count = std::count_if(head.fields.begin(), head.fields.end(),
                                     [&](const auto& field) { return field.first == name; });
    if (count > 1)
      Refuse(400, "the header field '" + std::string(name) + "' stands more than once");
  }
  // The library writes its own notes under these names and finds the forged ones first.
  for (const char* forged : {"remote_addr", "remote_port", "local_addr", "local_port"})
    if (head.Find(forged))
      Refuse(400, std::string("the header field '") + forged + "' is not for clients");
  if (head.version == "HTTP/1.1" && !head.Find("host")) Refuse(400, "the request names no host");
  if (head.Find("transfer-encoding"))
    Refuse(411, "the request needs a Content-Length, not a transfer encoding");
  if (head.Find("content-encoding")) Refuse(415, "the body must not be encoded");
  const std::string range = head.Find("range").value_or("");
  if (range.find(',') != std::string::npos) Refuse(416, "one range at a time");
  RefuseForeignChange(head);
  return ContentLengthOf(head);
}

std::string ToText(const RequestHead& head, std::int64_t body_length) {
  std::string text = head.method + " " + head.target + " " + head.version + "\r\n";
  for (const auto& [name, value] : head.fields) {
    // Ranges are answered by file_response.cpp, and what is packed by viewer_files.cpp: the
    // library would do both, wrongly or slowly.
    const bool is_ours = name == "content-length" || name == "range" || name == kRangeField ||
                         name == "accept-encoding" || name == kEncodingField;
    if (!is_ours) text.append(name).append(": ").append(value).append("\r\n");
    if (name == "range") text.append(kRangeField).append(": ").append(value).append("\r\n");
    if (name == "accept-encoding")
      text.append(kEncodingField).append(": ").append(value).append("\r\n");
  }
  return text + "content-length: " + std::to_string(body_length) + "\r\n\r\n";
}

}  // namespace parkade

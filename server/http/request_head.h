#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/http/problem.h"

namespace parkade {

/// Request line and header fields as they came over the wire, before anything of
/// the HTTP library has seen them.
struct RequestHead {
  std::string method;
  std::string target;  ///< path and query
  std::string version;
  std::vector<std::pair<std::string, std::string>> fields;  ///< names in lower case, values trimmed

  /// The value of a field that may stand once; nothing where absent.
  std::optional<std::string> Find(std::string_view name) const;
  std::string Path() const { return target.substr(0, target.find('?')); }
};

/// Parses the text up to and including the empty line. Strict where RFC 9112
/// allows to be: lines end with CR LF, names are tokens, no folding, no control bytes, not even
/// written as %0d or %00. A target that names the host, "http://HOST/PATH", sets the Host field.
/// Throws HttpError{400, 505}.
RequestHead ParseRequestHead(std::string_view text);

/// Refuses requests that the HTTP library would get wrong or that cost memory before our code runs
/// (measured on cpp-httplib 0.11.4): transfer encodings (411), content encodings (415), missing
/// (411), repeated or malformed (400) and oversized (413) Content-Length, several ranges (416),
/// forged connection fields (400), changes asked for by another site's page (403). Throws
/// HttpError. Returns the length of the body.
std::int64_t CheckRequestHead(const RequestHead& head);

/// Under this name the Range field is handed to our own code, past the library's.
constexpr const char* kRangeField = "x-parkade-range";
constexpr const char* kEncodingField = "x-parkade-accept-encoding";

/// The head as text for the HTTP library, with a Content-Length in every case.
std::string ToText(const RequestHead& head, std::int64_t body_length);

}  // namespace parkade

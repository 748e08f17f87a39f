#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace parkade {

/// The field that a request's id comes and goes in.
constexpr const char* kRequestIdField = "X-Request-ID";

/// What the log says of a request. Never more of its head than is here: it holds secrets, and so
/// does the query.
struct RequestTrace {
  std::string id;  ///< stands in every line that is written for the request, and in the answer
  std::string method;
  std::string path;
  std::string client;  ///< address
  int status = 0;      ///< 0 until it is answered
};

/// What came as X-Request-ID, where that is 1 to 64 letters, digits, dots, dashes or underscores;
/// else a new one.
std::string RequestIdFrom(const std::optional<std::string>& field);

/// The address of a client as a proxy hands it on, in the form that addresses have here; nothing
/// where it is none.
std::optional<std::string> ClientAddressFrom(const std::optional<std::string>& field);

/// How a request was answered.
struct AccessFigures {
  const char* route_class = "";
  std::int64_t bytes_in = 0;   ///< of its body
  std::int64_t bytes_out = 0;  ///< of the answer, with its head
  std::chrono::duration<double, std::milli> duration{};
};

/// Whether LogAccess writes lines; not, at first. Thread-safe.
void SetAccessLog(bool is_on);

/// Writes the line of an answered request.
void LogAccess(const RequestTrace& trace, const AccessFigures& figures);

}  // namespace parkade

#include "server/http/json_response.h"

#include <charconv>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kMaxLimit = 200;

std::optional<std::int64_t> Number(const std::string& text) {
  std::int64_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

void SendJson(httplib::Response& response, int status, const Json& json) {
  response.status = status;
  response.set_header("Cache-Control", "no-store");
  response.set_content(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n",
                       "application/json");
}

std::optional<std::string> QueryParameter(const httplib::Request& request, const char* name) {
  Require(request.get_param_value_count(name) <= 1, ErrorCode::kInvalidInput,
          std::string("the parameter '") + name + "' stands more than once");
  std::string value = request.get_param_value(name);
  if (value.empty()) return std::nullopt;
  return value;
}

Page PageOf(const httplib::Request& request) {
  Page page;
  if (const auto limit = QueryParameter(request, "limit")) {
    const std::int64_t number = Number(*limit).value_or(0);
    Require(number >= 1 && number <= kMaxLimit, ErrorCode::kInvalidInput,
            "'limit' is a number from 1 to 200");
    page.limit = static_cast<int>(number);
  }
  if (const auto cursor = QueryParameter(request, "cursor")) {
    const std::optional<std::int64_t> before = Number(*cursor);
    Require(before.has_value(), ErrorCode::kInvalidInput,
            "'cursor' is not a value this service gave");
    page.before = *before;
  }
  return page;
}

std::string ReadBody(const httplib::ContentReader& body, size_t max_bytes) {
  std::string text;
  bool is_too_large = false;
  const bool is_complete = body([&](const char* data, size_t size) {
    is_too_large = size > max_bytes - text.size();
    if (!is_too_large) text.append(data, size);
    return !is_too_large;
  });
  Require(!is_too_large, ErrorCode::kInvalidInput,
          "the body is too large: at most " + std::to_string(max_bytes) + " bytes are taken");
  Require(is_complete, ErrorCode::kInvalidInput, "the request broke off");
  return text;
}

}  // namespace parkade

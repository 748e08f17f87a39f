#include "server/store/access/access_rules.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

constexpr size_t kMaxLabelBytes = 100;
constexpr std::int64_t kMaxDays = 3650;

bool IsUtf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

}  // namespace

void RequireLabel(const std::string& name, const char* what) {
  const bool has_control = std::any_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
  Require(!name.empty() && name.size() <= kMaxLabelBytes && !has_control && IsUtf8(name),
          ErrorCode::kInvalidInput,
          std::string("the name of a ") + what +
              " is 1 to 100 bytes of UTF-8 without control characters");
}

void RequireFuture(const std::string& time) {
  Require(time > NowUtc(), ErrorCode::kInvalidInput, "the end '" + time + "' has passed");
}

std::string EndAfterDays(std::int64_t days) {
  Require(days >= 1 && days <= kMaxDays, ErrorCode::kInvalidInput,
          "something ends after 1 to 3650 days");
  return UtcIn(std::chrono::hours(24) * days);
}

}  // namespace parkade

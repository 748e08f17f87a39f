#include "server/store/access/access_rules.h"

#include <chrono>

#include "core/error.h"
#include "server/store/tables/names.h"
#include "server/store/tables/text_rules.h"

namespace parkade {
namespace {

constexpr size_t kMaxLabelBytes = 100;
constexpr std::int64_t kMaxDays = 3650;

}  // namespace

void RequireLabel(const std::string& name) {
  CheckText(name, {.name = "name", .max_bytes = kMaxLabelBytes, .is_required = true});
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

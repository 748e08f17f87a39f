#pragma once

#include <cstdint>
#include <string>

namespace parkade {

// What tokens and share links have in common. Each throws Error{kInvalidInput}.

/// Requires a name for people: one line of at most 100 bytes of UTF-8.
void RequireLabel(const std::string& name);

/// Requires a time as UtcText writes it, and one to come.
void RequireFuture(const std::string& time);

/// The time in `days`, which are 1 to 3650.
std::string EndAfterDays(std::int64_t days);

}  // namespace parkade

#pragma once

#include "server/http/route_table.h"
#include "server/store/access/caller.h"

namespace parkade {

/// Whether the caller's role, link and rights are enough for the right; of what sites is not asked.
bool HasRight(const Caller& caller, Right right);

/// Whether the caller has the right for its own things only.
bool NeedsToOwn(const Caller& caller, Right right);

/// What the right takes, one sentence.
const char* NeedOf(Right right);

}  // namespace parkade

#pragma once

#include <functional>

#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// Reads the logs of a job and compares them with what the store says of them: a log that rotted
/// would give a map that is wrong without a word. Throws Error{kInternal} for one that did, after
/// it was noted. `go_on` is asked often; where it says false, nothing is known.
void CheckLogs(Store& store, const Job& job, const std::function<bool()>& go_on);

}  // namespace parkade

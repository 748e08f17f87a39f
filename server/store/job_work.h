#pragma once

#include <chrono>
#include <string>

#include "server/store/store.h"

namespace parkade {

// What the attempts of a job have found lies in jobs/<id>/worker/work, so that the next attempt
// goes on where the last one ended. It goes where there will be none, and with the drives that it
// tells of.

/// How long it stays with a job that has failed or was cancelled.
constexpr std::chrono::days kWorkLifetime{7};

/// Removes what was found for a job. A file that cannot go is no error: it is tried again later.
void DropWork(const Store& store, const std::string& job_id);

/// Removes what was found for jobs of the drive's site, but for a running one.
void DropWorkOfDrive(Store& store, const std::string& drive_id);

/// Removes what was found for jobs that are done, that ended more than kWorkLifetime before `now`,
/// or of whose drives one was deleted.
void DropStaleWork(Store& store, std::chrono::system_clock::time_point now);

}  // namespace parkade

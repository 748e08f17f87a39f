#pragma once

#include <filesystem>

#include "server/store/records.h"
#include "server/store/store.h"

namespace parkade {

/// Makes what a finished attempt left in `staging` the next version of its site
/// and ends the job: every file is hashed and made durable, the folder is
/// renamed into the store, and one transaction makes it visible. Readers see the
/// old state or the new one. Throws Error{kInternal} when the products are not
/// a map or hold links or odd names, Error{kConflict} when the attempt is no
/// longer the running one, Error{kDiskFull}; nothing is published then, and what
/// was staged is gone or still in `staging`.
MapVersion PublishMap(Store& store, const Job& job, const std::filesystem::path& staging);

}  // namespace parkade

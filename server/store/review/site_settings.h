#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// What is to change about a site; nothing where it stays as it is. The inner nothing of
/// members that have one takes a setting away.
struct SiteChange {
  std::optional<std::string> title = {}, note = {};
  std::optional<std::optional<std::int64_t>> log_days = {},
                                             map_days = {};  ///< [days] that they are kept
  std::optional<std::optional<std::string>> default_rig = {};
  std::optional<std::optional<std::vector<ChecklistItem>>> review_checklist = {};
};

struct ChangedSite {
  Site site;
  bool is_new = false;
};

/// Changes the site, or makes it. Durable when it returns. Throws Error{kInvalidInput} for names,
/// texts, days and checklists that are not to be had, and for a rig that does not exist.
ChangedSite ChangeSite(Store& store, const std::string& name, const SiteChange& change);

}  // namespace parkade

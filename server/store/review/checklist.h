#pragma once

#include <string>
#include <vector>

#include "server/store/store.h"
#include "server/store/tables/review_table.h"

namespace parkade {

// What reviewers look at before they decide on a version: the list of its site, or the usual one,
// and what is ticked of it. Ticks are of one version, and are seen by everybody.

/// The list of sites that have none of their own. Its ids stay as they are: the viewer leads from
/// them to what is to be looked at.
const std::vector<ChecklistItem>& UsualChecklist();

/// Throws Error{kInvalidInput} for lists that are too long, texts of more than a line, and ids that
/// are no plain names or stand twice.
void CheckChecklist(const std::vector<ChecklistItem>& items);

struct Checklist {
  std::string site;
  std::int64_t version = 0;
  bool is_usual = false;  ///< the site has none of its own
  std::vector<ChecklistEntry> entries;
};

/// Throws Error{kNotFound}.
Checklist ChecklistOf(Store& store, const std::string& site, std::int64_t version);

/// Ticks an item, or takes its tick away. Who ticked it first stays. Durable when it returns.
/// Throws Error{kNotFound} for an unknown version or item.
Checklist TickItem(Store& store, const std::string& site, std::int64_t version,
                   const std::string& item, bool is_ticked, const std::string& author);

/// The checklist of a version within a transaction.
std::vector<ChecklistEntry> EntriesOf(Connection& connection, const MapVersion& map);

}  // namespace parkade

#pragma once

#include <string>

#include "server/store/tables/database.h"
#include "server/store/tables/delivery_table.h"
#include "server/store/tables/records.h"
#include "server/store/tables/review_table.h"

namespace parkade {

// What webhooks are told. Each is called in the transaction of the change, so that a crash loses
// neither the change nor the word of it; nothing is written where nobody asked to be told.

/// Event "job": it has ended, as `job` says.
void NoteJobEnd(Connection& connection, const Job& job);

/// Event "published".
void NotePublished(Connection& connection, const MapVersion& map);

/// Event "reviewed": the state of a version has changed.
void NoteReviewed(Connection& connection, const MapVersion& map, const ReviewEntry& entry);

/// Event "test" for one webhook, whatever it asked for.
Delivery NoteTest(Connection& connection, const std::string& webhook);

}  // namespace parkade

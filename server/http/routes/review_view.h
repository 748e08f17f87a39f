#pragma once

#include <httplib.h>

#include <vector>

#include "server/http/json_view.h"
#include "server/store/review/checklist.h"
#include "server/store/review/review.h"
#include "server/store/tables/comment_table.h"
#include "server/store/tables/delivery_table.h"
#include "server/store/tables/measurement_table.h"
#include "server/store/tables/webhook_table.h"

namespace parkade {

// Rows about reviews and webhooks as the API shows them (openapi.json, components/schemas).

Json ToJson(const ReviewEntry& entry);
Json ToJson(const Checklist& checklist);
Json ToJson(const Comment& comment);
Json ToJson(const CommentThread& thread);
Json ToJson(const Measurement& measurement);
/// Without its secret, which is shown once.
Json ToJson(const Webhook& webhook);
Json ToJson(const Delivery& delivery);

/// State, counts and the page of the history that the status holds.
Json ToJson(const ReviewStatus& status);

/// The states that the parameter `review_state` names, with commas between; empty where it is
/// absent. Throws Error{kInvalidInput} for other words.
std::vector<ReviewState> ReviewStatesOf(const httplib::Request& request);

}  // namespace parkade

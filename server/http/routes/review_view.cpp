#include "server/http/routes/review_view.h"

#include <sstream>

#include "server/http/json_response.h"
#include "server/store/review/measurements.h"

namespace parkade {
namespace {

Json PinOrNull(const CommentPin& pin) {
  if (pin == CommentPin{}) return nullptr;
  Json json = Json::object();
  if (pin.point) json["point"] = *pin.point;
  if (pin.drive) json["drive"] = *pin.drive;
  if (pin.time) json["time"] = *pin.time;
  if (pin.slot) json["slot"] = *pin.slot;
  if (pin.loop) json["loop"] = *pin.loop;
  return json;
}

Json EntriesToJson(const std::vector<ChecklistEntry>& entries) {
  Json json = Json::array();
  for (const ChecklistEntry& entry : entries)
    json.push_back({{"id", entry.item.id},
                    {"text", entry.item.text},
                    {"ticked_by", OrNull(entry.ticked_by)},
                    {"ticked_at", OrNull(entry.ticked_at)}});
  return json;
}

}  // namespace

Json ToJson(const ReviewEntry& entry) {
  return {{"action", entry.action},
          {"from", ToText(entry.from)},
          {"to", ToText(entry.to)},
          {"comment", entry.comment},
          {"author", entry.author},
          {"created_at", entry.created_at},
          {"checklist", entry.checklist ? EntriesToJson(*entry.checklist) : Json(nullptr)}};
}

Json ToJson(const Checklist& checklist) {
  return {{"site", checklist.site},
          {"version", checklist.version},
          {"usual", checklist.is_usual},
          {"items", EntriesToJson(checklist.entries)}};
}

Json ToJson(const CommentThread& thread) {
  return {{"first", ToJson(thread.first)},
          {"answers", thread.num_answers},
          {"last_author", thread.last_author},
          {"last_at", thread.last_at},
          {"review_state", ToText(thread.review_state)}};
}

Json ToJson(const Comment& comment) {
  return {{"id", comment.id},
          {"site", comment.site},
          {"version", comment.version},
          {"thread", OrNull(comment.thread)},
          {"text", comment.text},
          {"pin", PinOrNull(comment.pin)},
          {"author", comment.author},
          {"created_at", comment.created_at},
          {"edited_at", OrNull(comment.edited_at)},
          {"resolved_at", OrNull(comment.resolved_at)},
          {"resolved_by", OrNull(comment.resolved_by)},
          {"deleted", comment.deleted_at.has_value()}};
}

Json ToJson(const Measurement& measurement) {
  const MeasuredValue value = ValueOf(measurement);
  return {{"id", measurement.id},           {"site", measurement.site},
          {"version", measurement.version}, {"kind", ToText(measurement.kind)},
          {"title", measurement.title},     {"points", measurement.points},
          {"value", value.value},           {"unit", value.unit},
          {"author", measurement.author},   {"created_at", measurement.created_at}};
}

Json ToJson(const Webhook& webhook) {
  return {{"id", webhook.id},         {"url", webhook.url},
          {"events", webhook.events}, {"site", OrNull(webhook.site)},
          {"author", webhook.author}, {"created_at", webhook.created_at}};
}

Json ToJson(const Delivery& delivery) {
  const bool is_waiting = delivery.state == DeliveryState::kWaiting;
  return {{"id", delivery.id},
          {"event", delivery.event},
          {"state", ToText(delivery.state)},
          {"attempts", delivery.attempts},
          {"due_at", is_waiting ? Json(delivery.due_at) : Json(nullptr)},
          {"status", OrNull(delivery.status)},
          {"duration_ms", OrNull(delivery.duration_ms)},
          {"error", OrNull(delivery.error)},
          {"created_at", delivery.created_at},
          {"finished_at", OrNull(delivery.finished_at)},
          {"body", Json::parse(delivery.body, nullptr, /*allow_exceptions=*/false)}};
}

Json ToJson(const ReviewStatus& status) {
  Json json = {{"site", status.map.site},
               {"version", status.map.version},
               {"state", ToText(status.map.review_state)},
               {"counts",
                {{"entries", status.num_entries},
                 {"comments", status.comments.comments},
                 {"open_threads", status.comments.open_threads},
                 {"resolved_threads", status.comments.resolved_threads}}},
               {"history", Json::array()}};
  for (const ReviewEntry& entry : status.history) json["history"].push_back(ToJson(entry));
  return json;
}

std::vector<ReviewState> ReviewStatesOf(const httplib::Request& request) {
  std::vector<ReviewState> states;
  std::istringstream words(QueryParameter(request, "review_state").value_or(""));
  for (std::string word; std::getline(words, word, ',');) states.push_back(ParseReviewState(word));
  return states;
}

}  // namespace parkade

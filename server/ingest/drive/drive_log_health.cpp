#include "server/ingest/drive/drive_log_health.h"

#include <nlohmann/json.hpp>
#include <numeric>

namespace parkade {

const char* NameOf(DropReason reason) {
  switch (reason) {
    case DropReason::kDamaged: return "damaged";
    case DropReason::kRepeated: return "repeated";
    case DropReason::kBackwardStamp: return "backward_stamp";
    case DropReason::kOffClock: return "off_clock";
    case DropReason::kNotFinite: return "not_finite";
    case DropReason::kStuck: return "stuck";
    case DropReason::kNoFix: return "no_fix";
    case DropReason::kLate: return "late";
    case DropReason::kWrongSize: return "wrong_size";
    case DropReason::kWaitsForKeyFrame: return "waits_for_key_frame";
  }
  return "unknown";
}

std::uint64_t StreamHealth::NumDropped() const {
  return std::accumulate(num_dropped.begin(), num_dropped.end(), std::uint64_t{0});
}

void StreamHealth::Include(Timestamp time) {
  if (!span.IsEmpty() && time - span.end > longest_gap) {
    longest_gap = time - span.end;
    longest_gap_begin = span.end;
  }
  span.Include(time);
}

nlohmann::json HealthToJson(const DriveLogHealth& health) {
  nlohmann::json streams = nlohmann::json::array();
  for (const StreamHealth& stream : health.streams) {
    nlohmann::json dropped = nlohmann::json::object();
    for (std::size_t i = 0; i < kNumDropReasons; ++i)
      if (stream.num_dropped[i] > 0)
        dropped[NameOf(static_cast<DropReason>(i))] = stream.num_dropped[i];
    const std::uint64_t count = stream.num_delivered;
    const double seconds = stream.span.Seconds();
    nlohmann::json json = {
        {"role", stream.role},
        {"topic", stream.topic},
        {"delivered", count},
        {"dropped", dropped},
        {"rate_hz", count > 1 && seconds > 0 ? static_cast<double>(count - 1) / seconds : 0.0},
        {"longest_gap_s", stream.longest_gap}};
    if (!stream.span.IsEmpty()) {
      json["begin"] = ToDecimalSeconds(stream.span.begin);
      json["end"] = ToDecimalSeconds(stream.span.end);
      json["longest_gap_begin"] = ToDecimalSeconds(stream.longest_gap_begin);
    }
    streams.push_back(std::move(json));
  }
  nlohmann::json lost = nlohmann::json::array();
  for (const LostRange& range : health.damage.ranges)
    lost.push_back(
        {{"what", range.what}, {"topic", range.topic}, {"messages", range.num_messages}});
  return {{"streams", streams},
          {"lost", lost},
          {"num_lost_messages", health.damage.num_lost_messages},
          {"is_truncated", health.damage.is_truncated},
          {"findings", ToJson(health.findings)},
          {"warnings", health.Warnings()}};
}

}  // namespace parkade

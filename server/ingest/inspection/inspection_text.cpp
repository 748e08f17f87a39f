#include <cstdio>
#include <nlohmann/json.hpp>

#include "server/ingest/inspection/inspect_log.h"

namespace parkade {
namespace {

const char* NameOf(LogState state) {
  switch (state) {
    case LogState::kClean: return "clean";
    case LogState::kLossy: return "lossy";
    case LogState::kUnusable: break;
  }
  return "unusable";
}

template <typename... Values>
std::string Format(const char* format, Values... values) {
  std::array<char, 512> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

/// Names in a log come from strangers: no byte of them may steer the terminal.
std::string Printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

std::string Seconds(double seconds) { return Format(seconds < 10 ? "%.3g s" : "%.1f s", seconds); }

/// The time since the log's begin, which reads better than an epoch.
std::string Since(const LogInspection& log, Timestamp time) {
  return Format("%+.3f s", time - log.span.begin);
}

std::string RowOf(const TopicInspection& topic) {
  std::string row = Format("  %-36s %-34s %8llu %9.2f", Printable(topic.topic).c_str(),
                           Printable(topic.type).c_str(),
                           static_cast<unsigned long long>(topic.num_messages), topic.RateHz());
  if (topic.width > 0) row += Format("  %dx%d", topic.width, topic.height);
  if (!topic.image_encoding.empty()) row += " " + Printable(topic.image_encoding.substr(0, 60));
  return row + "\n";
}

constexpr std::size_t kMaxGaps = 3;  // that are printed

std::string ImageNote(const CameraFault& fault) {
  switch (fault.kind) {
    case CameraFault::Kind::kDark: return "dark";
    case CameraFault::Kind::kUnchanged: return "the image does not change";
    case CameraFault::Kind::kCovered: break;
  }
  return Format("covered, at least %.0f %% of the image,", 100 * fault.share);
}

std::string NotesOf(const LogInspection& log, const TopicInspection& topic) {
  std::string notes;
  const auto count = [&](std::uint64_t number, const char* what) {
    if (number > 0) notes += (notes.empty() ? "" : ", ") + std::to_string(number) + " " + what;
  };
  count(topic.num_undecodable, "damaged");
  count(topic.num_implausible, "with impossible values");
  count(topic.num_other_sizes, "of another size");
  count(topic.num_repeated, "repeated");
  count(topic.num_backward, "back in time");
  count(topic.num_without_stamp, "without a stamp");
  if (topic.num_backward > 0) notes += " (by up to " + Seconds(topic.largest_backward_jump) + ")";
  if (!topic.first_fault.empty()) notes += "; first: " + Printable(topic.first_fault);
  for (std::size_t i = 0; i < std::min(kMaxGaps, topic.gaps.size()); ++i)
    notes += (notes.empty() ? "" : "; ") + ("gap of " + Seconds(topic.gaps[i].seconds)) + " at " +
             Since(log, topic.gaps[i].begin);
  if (topic.gaps.size() > kMaxGaps) notes += "; shorter gaps";
  for (const CameraFault& fault : topic.image_faults)
    notes += (notes.empty() ? "" : "; ") + ImageNote(fault) + " from " + Since(log, fault.begin) +
             " to " + Since(log, fault.end);
  return notes.empty() ? "" : "  " + Printable(topic.topic) + ": " + notes + "\n";
}

std::string RigText(const Rig& rig) {
  std::string text =
      Format("rig: IMU %s at %.0f Hz", Printable(rig.imu.topic).c_str(), rig.imu.update_rate);
  text += rig.vehicle ? ", body frame known\n" : ", no body frame (vehicle.yaml)\n";
  for (const RigCamera& camera : rig.cameras)
    text += Format("  %s %s %dx%d, time shift %.4f s\n", Printable(camera.name).c_str(),
                   Printable(camera.topic).c_str(), camera.model.width(), camera.model.height(),
                   camera.time_shift);
  return text;
}

nlohmann::json ToJson(const TopicInspection& topic) {
  nlohmann::json gaps = nlohmann::json::array();
  for (const TopicInspection::Gap& gap : topic.gaps)
    gaps.push_back({{"begin", ToDecimalSeconds(gap.begin)}, {"seconds", gap.seconds}});
  nlohmann::json json = {{"topic", topic.topic},
                         {"type", topic.type},
                         {"messages", topic.num_messages},
                         {"bytes", topic.num_bytes},
                         {"rate_hz", topic.RateHz()},
                         {"duration_s", topic.span.Seconds()},
                         {"gaps", gaps},
                         {"repeated", topic.num_repeated},
                         {"backward", topic.num_backward},
                         {"largest_backward_jump_s", topic.largest_backward_jump},
                         {"without_stamp", topic.num_without_stamp},
                         {"damaged", topic.num_undecodable},
                         {"implausible", topic.num_implausible},
                         {"other_sizes", topic.num_other_sizes},
                         {"first_fault", topic.first_fault}};
  if (!topic.span.IsEmpty()) {
    json["begin"] = ToDecimalSeconds(topic.span.begin);
    json["end"] = ToDecimalSeconds(topic.span.end);
  }
  nlohmann::json image_faults = nlohmann::json::array();
  for (const CameraFault& fault : topic.image_faults)
    image_faults.push_back({{"kind", NameOf(fault.kind)},
                            {"begin", ToDecimalSeconds(fault.begin)},
                            {"end", ToDecimalSeconds(fault.end)},
                            {"share", fault.share}});
  if (topic.width > 0) {
    json["picture_faults"] = image_faults;
    json["width"] = topic.width;
    json["height"] = topic.height;
  }
  if (!topic.image_encoding.empty()) json["encoding"] = topic.image_encoding;
  return json;
}

nlohmann::json ToJson(const DamageReport& damage) {
  nlohmann::json ranges = nlohmann::json::array();
  for (const LostRange& range : damage.ranges) {
    nlohmann::json json = {
        {"what", range.what}, {"topic", range.topic}, {"messages", range.num_messages}};
    if (!range.time.IsEmpty()) {
      json["begin"] = ToDecimalSeconds(range.time.begin);
      json["end"] = ToDecimalSeconds(range.time.end);
    }
    ranges.push_back(std::move(json));
  }
  return {{"ranges", ranges},
          {"lost_messages", damage.num_lost_messages},
          {"is_truncated", damage.is_truncated}};
}

nlohmann::json ToJson(const Rig& rig) {
  nlohmann::json cameras = nlohmann::json::array();
  for (const RigCamera& camera : rig.cameras)
    cameras.push_back({{"name", camera.name},
                       {"topic", camera.topic},
                       {"width", camera.model.width()},
                       {"height", camera.model.height()},
                       {"time_shift_s", camera.time_shift}});
  return {
      {"imu", rig.imu.topic}, {"has_body_frame", rig.vehicle.has_value()}, {"cameras", cameras}};
}

}  // namespace

std::string InspectionToText(const LogInspection& log) {
  std::string text = Printable(log.name) + ": " + log.format + ", " + Seconds(log.span.Seconds()) +
                     Format(", %.1f MB\n", static_cast<double>(log.num_bytes) * 1e-6);
  text += Format("  %-36s %-34s %8s %9s\n", "topic", "type", "messages", "rate [Hz]");
  for (const TopicInspection& topic : log.topics) text += RowOf(topic);
  std::string notes;
  for (const TopicInspection& topic : log.topics) notes += NotesOf(log, topic);
  if (!notes.empty()) text += "found:\n" + notes;
  if (!log.damage.IsClean())
    text += Format("damage: %llu messages lost%s\n",
                   static_cast<unsigned long long>(log.damage.num_lost_messages),
                   log.damage.is_truncated ? ", the log is cut off" : "");
  for (const LostRange& range : log.damage.ranges) {
    text += "  " + Printable(range.what);
    if (!range.time.IsEmpty())
      text += ", " + Since(log, range.time.begin) + " to " + Since(log, range.time.end);
    text += "\n";
  }
  if (log.rig) text += RigText(*log.rig);
  for (const Severity severity : {Severity::kWarning, Severity::kNote})
    for (const std::string& finding : TextsOf(log.findings, severity))
      text += std::string(NameOf(severity)) + ": " + Printable(finding) + "\n";
  for (const std::string& missing : log.missing)
    text += "missing for a map: " + Printable(missing) + "\n";
  text += std::string("state: ") + NameOf(log.state);
  return text + (log.is_of_beginning ? ", only the beginning was read\n" : "\n");
}

nlohmann::json InspectionToJson(const LogInspection& log) {
  nlohmann::json topics = nlohmann::json::array();
  for (const TopicInspection& topic : log.topics) topics.push_back(ToJson(topic));
  nlohmann::json json = {{"name", log.name},
                         {"format", log.format},
                         {"bytes", log.num_bytes},
                         {"duration_s", log.span.Seconds()},
                         {"topics", topics},
                         {"damage", ToJson(log.damage)},
                         {"rig", nullptr},
                         {"missing", log.missing},
                         {"findings", ToJson(log.findings)},
                         {"warnings", WarningsOf(log.findings)},
                         {"state", NameOf(log.state)},
                         {"is_of_beginning", log.is_of_beginning},
                         {"exit_status", log.ExitStatus()}};
  if (!log.span.IsEmpty()) {
    json["begin"] = ToDecimalSeconds(log.span.begin);
    json["end"] = ToDecimalSeconds(log.span.end);
  }
  if (log.rig) json["rig"] = ToJson(*log.rig);
  return json;
}

}  // namespace parkade

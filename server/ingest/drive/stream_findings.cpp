#include "server/ingest/drive/stream_findings.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr double kMuch = 0.1;  // share of a stream

/// Why, for a person.
std::string ReasonOf(DropReason reason, StreamKind kind) {
  switch (reason) {
    case DropReason::kDamaged: return "are damaged";
    case DropReason::kRepeated: return "repeat the stamp before them";
    case DropReason::kBackwardStamp: return "have stamps that go back in time";
    case DropReason::kOffClock:
      return kind == StreamKind::kImu ? "have stamps that leap"
                                      : "have stamps that are not on the IMU's clock";
    case DropReason::kNotFinite: return "hold values that no sensor of a car can measure";
    case DropReason::kStuck: return "repeat one reading";
    case DropReason::kNoFix: return "hold no position";
    case DropReason::kLate: return "come too late in the log";
    case DropReason::kWrongSize: return "are of another size than calibrated";
    case DropReason::kWaitsForKeyFrame: return "come before the first key frame of the video";
  }
  return "cannot be used";
}

std::string AdviceOn(DropReason reason) {
  switch (reason) {
    case DropReason::kOffClock:
    case DropReason::kBackwardStamp:
      return "stamp all sensors by one clock that is not set while it records";
    case DropReason::kNotFinite: return "check the units that its driver writes";
    case DropReason::kNoFix: return "check the antenna, and that the receiver had a position";
    default: return "";
  }
}

Finding LossOf(const SensorStream& stream, const StreamHealth& health, bool is_all) {
  const auto most = std::max_element(health.num_dropped.begin(), health.num_dropped.end());
  const auto reason = static_cast<DropReason>(most - health.num_dropped.begin());
  const std::uint64_t dropped = health.NumDropped(), all = dropped + health.num_delivered;
  Finding finding{is_all ? "stream_left_out" : "stream_loses_much",
                  Severity::kWarning,
                  stream.topic_name,
                  "",
                  AdviceOn(reason),
                  {}};
  finding.sentence = NameOf(stream) +
                     (is_all ? " is left out: all " + std::to_string(all)
                             : " loses " + std::to_string(dropped) + " of " + std::to_string(all)) +
                     " messages" + (is_all ? "" : ": most of these") + " " +
                     ReasonOf(reason, stream.kind);
  if (reason == DropReason::kOffClock && health.off_clock_by != 0)
    finding.sentence += std::string(", ") + DurationText(health.off_clock_by) +
                        (health.off_clock_by < 0 ? " behind it" : " ahead of it");
  finding.evidence = {{"messages", static_cast<double>(all)},
                      {"left_out", static_cast<double>(dropped)},
                      {"off_clock_by_s", health.off_clock_by}};
  if (is_all && stream.kind == StreamKind::kImu) {
    finding.severity = Severity::kUnusable;
    finding.sentence = NameOf(stream) + " has no usable sample: all " + std::to_string(all) +
                       " messages " + ReasonOf(reason, stream.kind);
  }
  return finding;
}

Finding UndecodableOf(const SensorStream& stream, const std::string& fault) {
  return {"undecodable_images",
          Severity::kWarning,
          stream.topic_name,
          NameOf(stream) + " is left out: none of its images can be decoded (" + fault + ")",
          "",
          {}};
}

/// What is wrong with all cameras, of which each has a finding.
Finding NoImages(const std::vector<Finding>& cameras) {
  if (cameras.empty())
    return {"no_images", Severity::kUnusable,
            "",          "the log has no image of any camera of the rig",
            "",          {}};
  Finding finding = cameras.front();
  finding.name = "no_images";
  finding.severity = Severity::kUnusable;
  finding.sentence = "no image of the log can be used: " + finding.sentence;
  if (cameras.size() > 1)
    finding.sentence +=
        ", and so with " + (cameras.size() == 2
                                ? "the other camera"
                                : "the " + std::to_string(cameras.size() - 1) + " others");
  return finding;
}

}  // namespace

std::string NameOf(const SensorStream& stream) {
  switch (stream.kind) {
    case StreamKind::kImu: return "the IMU " + stream.topic_name;
    case StreamKind::kWheels: return "the wheels " + stream.topic_name;
    case StreamKind::kGnss: return "the GNSS receiver " + stream.topic_name;
    case StreamKind::kImage: return "camera " + stream.role + " (" + stream.topic_name + ")";
    case StreamKind::kSemantic: break;
  }
  return "the masks " + stream.topic_name;
}

std::optional<Finding> FindLoss(const SensorStream& stream, const StreamHealth& health) {
  const auto dropped = static_cast<double>(health.NumDropped());
  if (dropped <= kMuch * (dropped + static_cast<double>(health.num_delivered))) return std::nullopt;
  return LossOf(stream, health, health.num_delivered == 0);
}

std::vector<Finding> FindLosses(const std::vector<SensorStream>& streams,
                                const std::vector<StreamHealth>& health,
                                const std::vector<std::string>& undecodable) {
  std::vector<Finding> findings, cameras;
  std::size_t num_cameras = 0;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const SensorStream& stream = streams[i];
    const bool is_camera = stream.kind == StreamKind::kImage;
    num_cameras += is_camera ? 1 : 0;
    const bool is_empty = health[i].num_delivered == 0;
    if (!undecodable[i].empty())
      (is_camera ? cameras : findings).push_back(UndecodableOf(stream, undecodable[i]));
    else if (is_empty && (health[i].NumDropped() > 0 || stream.kind == StreamKind::kImu))
      (is_camera ? cameras : findings).push_back(LossOf(stream, health[i], true));
    else if (is_empty && is_camera)
      cameras.push_back({"stream_empty",
                         Severity::kWarning,
                         stream.topic_name,
                         NameOf(stream) + " is left out: its topic holds no image",
                         "",
                         {}});
    else if (std::optional<Finding> loss = FindLoss(stream, health[i]))
      findings.push_back(std::move(*loss));
  }
  if (cameras.size() == num_cameras)
    findings.push_back(NoImages(cameras));
  else
    findings.insert(findings.end(), cameras.begin(), cameras.end());
  return findings;
}

}  // namespace parkade

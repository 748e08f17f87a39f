#include "server/ingest/drive/coverage_findings.h"

#include <algorithm>
#include <optional>

#include "server/ingest/drive/stream_findings.h"

namespace parkade {
namespace {

constexpr double kShortPart = 1;    // [s] at either end, in which recorders start and stop
constexpr double kMinPart = 2;      // [s] of a camera or of wheels
constexpr double kMuch = 0.1;       // share of the drive
constexpr double kShortGap = 0.25;  // [s] of an IMU
constexpr double kLongGap = 1;      // [s] of an IMU, beyond which the path is a guess

/// The part of a drive in which the IMU can be used.
TimeSpan UsableSpan(const SensorStream& imu, const StreamHealth& health) {
  TimeSpan span = health.span;
  for (const TimeSpan& stuck : imu.stuck) {
    if (stuck.Contains(span.end)) span.end = stuck.begin;
    if (stuck.Contains(span.begin)) span.begin = stuck.end;
  }
  return span;
}

Finding Uncovered(const char* name, Severity severity, const SensorStream& stream,
                  const std::string& what, double seconds) {
  return {name,
          severity,
          stream.topic_name,
          NameOf(stream) + " " + what,
          "check its driver, and what the recorder lost",
          {{"seconds", seconds}}};
}

void CheckImu(const SensorStream& imu, const StreamHealth& health, const TimeSpan& images,
              std::vector<Finding>& findings) {
  const TimeSpan usable = UsableSpan(imu, health);
  if (images.IsEmpty() || usable.IsEmpty()) return;
  const double before = usable.begin - images.begin, behind = images.end - usable.end;
  if (before > kShortPart)
    findings.push_back(Uncovered(
        "imu_begins_late", Severity::kWarning, imu,
        "begins " + DurationText(before) + " after the images: that time is not mapped", before));
  if (behind > kShortPart)
    findings.push_back(Uncovered(
        "imu_ends_early", Severity::kWarning, imu,
        "ends " + DurationText(behind) + " before the images: that time is not mapped", behind));
  if (health.longest_gap > kShortGap)
    findings.push_back(Uncovered(
        "imu_gap", health.longest_gap > kLongGap ? Severity::kWarning : Severity::kNote, imu,
        "is silent for " + DurationText(health.longest_gap) + " after " +
            DurationText(health.longest_gap_begin - health.span.begin) +
            ": the path there is a guess",
        health.longest_gap));
}

/// That a camera has too few images for anything to be followed from one to the next.
std::optional<Finding> CheckRate(const SensorStream& camera, const StreamHealth& health) {
  constexpr double kSlow = 1.5;  // [Hz]
  constexpr std::uint64_t kMinImages = 5;
  if (health.num_delivered < kMinImages || health.span.IsEmpty()) return std::nullopt;
  const double rate = static_cast<double>(health.num_delivered - 1) / health.span.Seconds();
  if (rate > kSlow) return std::nullopt;
  return Finding{"camera_slow",
                 Severity::kWarning,
                 camera.topic_name,
                 NameOf(camera) + FormatText(" has %.1f images a second only", rate),
                 "record 5 images a second or more; 10 are better",
                 {{"rate_hz", rate}}};
}

}  // namespace

std::vector<Finding> FindUncovered(const std::vector<SensorStream>& streams,
                                   const std::vector<StreamHealth>& health) {
  std::vector<Finding> findings;
  TimeSpan images;
  for (std::size_t i = 0; i < streams.size(); ++i)
    if (streams[i].kind == StreamKind::kImage && !health[i].span.IsEmpty()) {
      images.Include(health[i].span.begin);
      images.Include(health[i].span.end);
    }
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const StreamKind kind = streams[i].kind;
    if (kind == StreamKind::kImu) CheckImu(streams[i], health[i], images, findings);
    if (kind == StreamKind::kImage)
      if (std::optional<Finding> slow = CheckRate(streams[i], health[i]))
        findings.push_back(std::move(*slow));
    if ((kind != StreamKind::kImage && kind != StreamKind::kWheels) || health[i].span.IsEmpty())
      continue;
    const double missing = std::max(0.0, health[i].span.begin - images.begin) +
                           std::max(0.0, images.end - health[i].span.end);
    if (missing > std::max(kMinPart, kMuch * images.Seconds()))
      findings.push_back(Uncovered(
          "stream_covers_part", Severity::kWarning, streams[i],
          "is missing for " + DurationText(missing) + " of " + DurationText(images.Seconds()),
          missing));
  }
  return findings;
}

}  // namespace parkade

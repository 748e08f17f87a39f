#include "mapping/surface/cell_evidence.h"

#include <bit>
#include <numeric>

namespace parkade {
namespace {

constexpr float kChangeLogOdds =
    0.1F;  // from which a drive that contradicts those before it is believed alone
constexpr float kEarlierClasses = 0.5F;  // of their weight, for each drive that came later
constexpr int kViewDirections = 16;      // in which views are told apart
constexpr double kNearView = 4.0;        // [m] of distance from the camera
constexpr int kCoveringViews = 1;        // from which a drive misses what an earlier one saw
constexpr float kCoveredLogOdds = -1;    // of what is covered

}  // namespace

ViewSet ViewFrom(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) {
  const Eigen::Vector2d ray = (point - eye).head<2>();
  // A turn has eight eighths, told apart by signs and by which is longer, and each two halves.
  static_assert(kViewDirections == 16);
  constexpr double kHalf = 0.41421356237309503;  // tangent of a sixteenth of a turn
  const double x = std::abs(ray.x()), y = std::abs(ray.y());
  const bool is_steep = y > x, is_outer = is_steep ? x < kHalf * y : y < kHalf * x;
  const int direction = (ray.x() < 0) | (ray.y() < 0) << 1 | is_steep << 2 | is_outer << 3;
  return ViewSet{1} << (direction +
                        (ray.squaredNorm() < kNearView * kNearView ? 0 : kViewDirections));
}

void CellEvidence::EndDrive() {
  // From where it was seen, something stands in the way now; from elsewhere it may always have
  // been hidden.
  const bool is_blocked = std::popcount(seen_from & shown_now.occupied_views) >= kCoveringViews;
  const float now = std::exchange(log_odds_now, 0.0F);
  const bool has_changed =
      now * log_odds < 0 && std::abs(now) >= kChangeLogOdds && (now > 0 || is_blocked || is_driven);
  log_odds = has_changed ? now : std::clamp(log_odds + now, -kLogOddsLimit, kLogOddsLimit);
  const bool is_covered = is_blocked && shown_now.free_views == 0;
  if (is_covered) {
    log_odds = std::min(log_odds, kCoveredLogOdds);
    seen_from = 0;
  }
  is_hit = false;
  for (float& weight : classes) weight *= kEarlierClasses;
  seen_from |= shown_now.free_views;
  shown_now.log_odds = now;
  const bool tells = (shown_now.free_views | shown_now.occupied_views) != 0;
  if (tells || shown.free + shown.occupied == 0) shown = shown_now;
  shown_now = {};
}

ObservationSummary CellEvidence::Summary() const {
  return {.free = ObservationSummary::PackLogOdds(shown.free),
          .occupied = ObservationSummary::PackLogOdds(shown.occupied),
          .nearness = observations.Nearness(),
          .disagreement = observations.Disagreement(),
          .free_views = static_cast<std::uint8_t>(std::popcount(shown.free_views)),
          .occupied_views = static_cast<std::uint8_t>(std::popcount(shown.occupied_views))};
}

std::array<std::uint8_t, kNumSurfaceClasses> CellEvidence::ClassBeliefs() const {
  std::array<std::uint8_t, kNumSurfaceClasses> beliefs{};
  const float sum = std::accumulate(classes.begin(), classes.end(), 0.0F);
  if (sum > 0)
    std::transform(classes.begin(), classes.end(), beliefs.begin(), [&](float weight) {
      return static_cast<std::uint8_t>(std::lround(255 * weight / sum));
    });
  return beliefs;
}

}  // namespace parkade

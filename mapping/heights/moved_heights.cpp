#include "mapping/heights/moved_heights.h"

#include <cstddef>
#include <optional>

#include "mapping/heights/height_sweep.h"
#include "mapping/heights/path_agreement.h"

namespace parkade {
namespace {

constexpr std::size_t kMaxPaths = 8;  // that a file may hold

}  // namespace

MovedHeights FindMovedHeights(const DriveHeights& heights, const Trajectory& now,
                              const HeightOptions& options) {
  MovedHeights moved{HeightsWorth::kNone, SweepSquares(options.field.spacing)};
  if (heights.along.empty()) return moved;
  bool do_some_hold = false;
  const auto add = [&](const PathAgreement& agreement, const Eigen::Vector3d& point) {
    if (agreement.HoldsAt(point))
      do_some_hold = true;
    else
      moved.squares.Add(point);
  };
  GroundSquares measured = SweepSquares(options.field.spacing);
  TiedPoints points(&now);
  auto next = heights.swept.begin();
  for (const HeightsAlong& along : heights.along) {
    const PathAgreement agreement(along.path, now);
    for (std::uint64_t i = 0; i < along.num_swept; ++i, ++next)
      if (const std::optional<Eigen::Vector3d> point = points.InSite(*next)) {
        measured.Add(*point);
        add(agreement, *point);
      }
  }
  const PathAgreement last(heights.along.back().path, now);
  for (const Eigen::Vector3d& place : last.Places())
    if (!measured.Has(place)) add(last, place);
  if (moved.squares.empty())
    moved.worth = HeightsWorth::kHold;
  else if (do_some_hold && heights.along.size() < kMaxPaths)
    moved.worth = HeightsWorth::kSome;
  return moved;
}

}  // namespace parkade

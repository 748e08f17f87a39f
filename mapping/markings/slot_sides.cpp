#include "mapping/markings/slot_sides.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kStep = 0.05;                  // [m] along a line
constexpr double kEnds = 0.3;                   // [m] of a line that do not count
constexpr double kMark = 0.4;                   // [m] of a mark beyond them
constexpr int kReach = 20;                      // steps to either side of a line
constexpr double kAcross = 0.025;               // [m] of such a step
constexpr int kMaxAside = 8;                    // steps that a line may lie beside its place
constexpr int kHalfStripe = 2;                  // steps, of a line's paint
constexpr int kNearest = 5, kFarthest = 10;     // steps from its middle to the ground beside it
constexpr float kDark = 30;                     // of 255: contrast in what is darker is noise
constexpr double kMinKnown = 0.6;               // of a line's length
constexpr double kPaint = 0.08, kBare = 0.035;  // of the ground's brightness, over it

/// How bright the ground is across a line, of its mean; the middle is the line's.
using Profile = std::array<double, 2 * kReach + 1>;

/// A square of ground that can be asked point by point.
class TileBrightness {
 public:
  explicit TileBrightness(const GroundTile& tile) : tile_(tile) {}

  /// As FindPaintLines has it: 0 to 255; nothing where the ground is not sure.
  std::optional<float> At(const Vector2d& place) const {
    const int column = static_cast<int>(std::floor((place.x() - tile_.left) / tile_.pixel_size));
    const int row = static_cast<int>(std::floor((tile_.top - place.y()) / tile_.pixel_size));
    if (column < 0 || row < 0 || column >= tile_.image.cols || row >= tile_.image.rows) return {};
    if (tile_.mask.at<std::uint8_t>(row, column) != GroundTile::kSure) return {};
    const cv::Vec3b& bgr = tile_.image.at<cv::Vec3b>(row, column);
    return 0.5F * static_cast<float>(bgr[1] + bgr[2]);
  }

 private:
  const GroundTile& tile_;
};

double MeanOf(const Profile& profile, int first, int last) {
  double sum = 0;
  for (int i = first; i <= last; ++i) sum += profile[static_cast<std::size_t>(i + kReach)];
  return sum / (last - first + 1);
}

/// The profile at one place along a line, if all of it is known and lit.
std::optional<Profile> ProfileAt(const TileBrightness& ground, const Vector2d& place,
                                 const Vector2d& across) {
  Profile profile{};
  for (int i = -kReach; i <= kReach; ++i) {
    const std::optional<float> brightness = ground.At(place + i * kAcross * across);
    if (!brightness) return {};
    profile[static_cast<std::size_t>(i + kReach)] = static_cast<double>(*brightness);
  }
  const double mean = MeanOf(profile, -kReach, kReach);
  if (mean < static_cast<double>(kDark)) return {};
  for (double& value : profile) value /= mean;
  return profile;
}

/// Paint is brighter than both sides, bare ground no brighter than their mean; the edge of a shadow
/// is neither.
PaintSeen Judge(const Profile& profile) {
  double ridge = 0, rise = 0;
  for (int at = -kMaxAside; at <= kMaxAside; ++at) {
    const double stripe = MeanOf(profile, at - kHalfStripe, at + kHalfStripe);
    const double left = MeanOf(profile, at - kFarthest, at - kNearest);
    const double right = MeanOf(profile, at + kNearest, at + kFarthest);
    ridge = std::max(ridge, stripe - std::max(left, right));
    rise = std::max(rise, stripe - 0.5 * (left + right));
  }
  return ridge > kPaint ? PaintSeen::kPainted
         : rise < kBare ? PaintSeen::kBare
                        : PaintSeen::kUnknown;
}

/// From one place to another.
PaintSeen SeeStretch(const TileBrightness& ground, const Vector2d& begin, const Vector2d& end) {
  const double length = (end - begin).norm();
  const Vector2d along = (end - begin) / length, across(-along.y(), along.x());
  Profile sum{};
  const int count = static_cast<int>(length / kStep) + 1;
  int num_known = 0;
  for (int step = 0; step < count; ++step)
    if (const auto profile = ProfileAt(ground, begin + step * kStep * along, across)) {
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += (*profile)[i];
      ++num_known;
    }
  if (num_known == 0 || num_known < kMinKnown * count) return PaintSeen::kUnknown;
  for (double& value : sum) value /= num_known;
  return Judge(sum);
}

/// Marks at its ends are paint, too, where there is nothing between (FindSlotsAtMarks).
PaintSeen SeeSide(const TileBrightness& ground, const Vector2d& begin, const Vector2d& end) {
  const Vector2d along = (end - begin).normalized(), first = begin + kEnds * along,
                 last = end - kEnds * along;
  const PaintSeen all = SeeStretch(ground, first, last);
  if (all != PaintSeen::kBare) return all;
  const bool is_marked = SeeStretch(ground, first, first + kMark * along) == PaintSeen::kPainted ||
                         SeeStretch(ground, last - kMark * along, last) == PaintSeen::kPainted;
  return is_marked ? PaintSeen::kPainted : PaintSeen::kBare;
}

bool IsIn(const GroundTile& tile, const ParkingSlot& slot) {
  constexpr double kMaxHeightStep = 1.2;  // [m] between things of one deck
  const Eigen::Vector3d center = slot.Center();
  return tile.core.contains(Vector2d(center.head<2>())) &&
         std::abs(center.z() - tile.height) < kMaxHeightStep;
}

}  // namespace

std::vector<SlotSides> SeeSides(const GroundTiles& tiles, const std::vector<ParkingSlot>& slots) {
  const auto seen = ParallelMap(tiles.size(), [&](std::size_t index) {
    const GroundTile tile = tiles.Make(index);
    const TileBrightness ground(tile);
    std::vector<std::pair<std::size_t, SlotSides>> sides;
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (!IsIn(tile, slots[i])) continue;
      const auto corner = [&](std::size_t k) -> Vector2d { return slots[i].corners[k].head<2>(); };
      sides.emplace_back(i, SlotSides{SeeSide(ground, corner(1), corner(2)),
                                      SeeSide(ground, corner(0), corner(3))});
    }
    return sides;
  });
  std::vector<SlotSides> all(slots.size(), SlotSides{});
  for (const auto& of_tile : seen)
    for (const auto& [slot, sides] : of_tile) all[slot] = sides;
  return all;
}

}  // namespace parkade

#include "mapping/roadside/parking_lane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace parkade {
namespace {

using Eigen::Vector3d;

constexpr double kFlankToKerb = 1.95;  // [m] of parked cars
constexpr int kWindow = 60;            // places to each side that say where the kerb is
constexpr double kBin = 0.1;           // [m]
constexpr double kSpread = 0.35;       // [m] by which those that agree may differ
constexpr int kMinVotes = 20;          // places
constexpr double kMinKerb = 2.4;       // [m] from the path: nearer there is no room for a car
constexpr double kMaxOpen = 0.8;       // [m] beyond the kerb: then it is none
constexpr double kMinInside = 1.1, kMaxInside = 2.7;  // [m] from a flank to the kerb
constexpr double kBare = 0.7;                         // [m] before the kerb that may hide

/// Counts of places by the distance at which they have the kerb.
class KerbVotes {
 public:
  void Add(const RoadsideSection& section, int count) {
    if (section.end == RoadsideEnd::kUnseen) return;
    const double kerb =
        section.free_width + (section.end == RoadsideEnd::kVehicle ? kFlankToKerb : 0);
    const int bin = static_cast<int>(kerb / kBin);
    if (kerb >= kMinKerb && bin < kNumBins) counts_[static_cast<std::size_t>(bin)] += count;
  }
  /// [m] where most agree; nothing where few do.
  std::optional<double> Mode() const {
    constexpr int kReach = static_cast<int>(kSpread / kBin);
    int best = 0;
    double kerb = 0;
    for (int middle = kReach; middle + kReach < kNumBins; ++middle) {
      int count = 0;
      double sum = 0;
      for (int bin = middle - kReach; bin <= middle + kReach; ++bin) {
        count += counts_[static_cast<std::size_t>(bin)];
        sum += counts_[static_cast<std::size_t>(bin)] * (bin + 0.5) * kBin;
      }
      if (count > best) best = count, kerb = sum / count;
    }
    if (best < kMinVotes) return {};
    return kerb;
  }

 private:
  static constexpr int kNumBins = static_cast<int>((Roadside::kReach + kFlankToKerb) / kBin) + 1;
  std::array<int, kNumBins> counts_{};
};

LaneState StateOf(const RoadsideSection& section, double kerb) {
  const double inside = kerb - section.free_width;
  switch (section.end) {
    case RoadsideEnd::kUnseen:
      return section.free_width > kerb + kMaxOpen       ? LaneState::kBlocked
             : section.free_width > 0 && inside < kBare ? LaneState::kFree
                                                        : LaneState::kUnseen;
    case RoadsideEnd::kVehicle:
      if (inside > kMinInside && inside < kMaxInside) return LaneState::kVehicle;
      [[fallthrough]];
    case RoadsideEnd::kOther:
      if (inside < -kMaxOpen) return LaneState::kBlocked;
      return inside < kBare ? LaneState::kFree : LaneState::kBlocked;
  }
  return LaneState::kUnseen;
}

}  // namespace

ParkingLane FindParkingLane(const Roadside& roadside) {
  const std::vector<RoadsideSection>& sections = roadside.sections;
  const int count = static_cast<int>(sections.size());
  KerbVotes votes;
  for (int i = 0; i < std::min(kWindow, count); ++i)
    votes.Add(sections[static_cast<std::size_t>(i)], 1);
  ParkingLane lane;
  Vector3d last = Vector3d::Zero();
  bool has_last = false;
  double left = 0;
  for (int i = 0; i < count; ++i) {
    if (i + kWindow < count) votes.Add(sections[static_cast<std::size_t>(i + kWindow)], 1);
    if (i > kWindow) votes.Add(sections[static_cast<std::size_t>(i - kWindow - 1)], -1);
    const RoadsideSection& section = sections[static_cast<std::size_t>(i)];
    const std::optional<double> kerb = votes.Mode();
    if (!kerb) continue;
    const double distance = *kerb - 0.5 * ParkingLane::kWidth;
    const Eigen::Vector2d middle = section.At(distance);
    const Vector3d place(middle.x(), middle.y(), section.place.z());
    const double step = has_last ? (place - last).head<2>().norm() : 0;
    const double length = has_last ? step : 0;
    const LaneState state = StateOf(section, *kerb);
    while (left <= length) {
      const double share = length > 0 ? left / length : 0;
      lane.places.emplace_back(has_last ? Vector3d(last + share * (place - last)) : place);
      lane.states.push_back(step > 1 ? LaneState::kUnseen : state);
      lane.path_distances.push_back(distance);
      left += ParkingLane::kStep;
    }
    left -= length;
    last = place, has_last = true;
  }
  return lane;
}

}  // namespace parkade

#include "mapping/texture/own_shade.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"

namespace parkade {
namespace {

// [m] Of most cars, beyond the wheels' contact area, and above the ground.
constexpr double kFrontOverhang = 0.85, kRearOverhang = 0.8, kSide = 0.12;
constexpr double kFloor = 0.2, kRoof = 1.5;

constexpr int kNumAzimuths = 72;
constexpr int kNumElevations = 17;
constexpr double kLowest = 8, kElevationStep = 4;  // [degrees] of the sun
constexpr int kNumFine = 4;                        // [degrees] around the best of them, by one
constexpr std::size_t kMinShaded = 60;             // samples
constexpr double kMinDarkness = 0.12;  // log: what is in the shade is at least 11 % darker
constexpr double kMinMatch = 0.5;      // correlation of what is dark with what is shaded
constexpr double kDark = 0.5;          // log: darker tells no more

/// How well a direction explains the samples.
struct Match {
  double correlation = -1;
  double darkness = 0;  ///< of what is shaded less that of the rest, in the mean
  std::size_t num_shaded = 0;
};

Eigen::Vector3d Direction(double azimuth, double elevation) {
  const double up = elevation * std::numbers::pi / 180, around = azimuth * std::numbers::pi / 180;
  return {std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)};
}

Match MatchOf(std::span<const ShadeSample> samples, const ShadeCaster& car,
              const Eigen::Vector3d& to_sun) {
  double sum = 0, square = 0, shaded_sum = 0;
  std::size_t shaded = 0;
  for (const ShadeSample& sample : samples) {
    const double darkness = std::clamp(static_cast<double>(sample.darkness), -kDark, kDark);
    sum += darkness, square += darkness * darkness;
    if (!car.Shades(sample.place, sample.ground_from_site * to_sun)) continue;
    shaded_sum += darkness;
    ++shaded;
  }
  const auto count = static_cast<double>(samples.size()), in = static_cast<double>(shaded),
             out = count - in;
  const double variance = square / count - sum / count * sum / count;
  if (shaded == 0 || out == 0 || variance <= 0) return {};
  const double difference = shaded_sum / in - (sum - shaded_sum) / out;
  return {difference * std::sqrt(in * out / (count * count * variance)), difference, shaded};
}

}  // namespace

ShadeCaster::ShadeCaster(const WheelbaseFootprint& contact, double margin) {
  if (contact.wheelbase <= 0 || contact.track <= 0) return;
  low_ = {-kRearOverhang - margin, -0.5 * contact.track - kSide - margin, kFloor};
  high_ = {contact.wheelbase + kFrontOverhang + margin, 0.5 * contact.track + kSide + margin,
           kRoof + margin};
}

bool ShadeCaster::Shades(const Eigen::Vector2d& place, const Eigen::Vector3d& to_sun) const {
  if (to_sun.z() <= 0) return false;
  // The part of the ray that is within the box's sides, one pair after the other.
  double begin = low_.z() / to_sun.z(), end = high_.z() / to_sun.z();
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(to_sun[axis]) < 1e-9) {
      if (place[axis] < low_[axis] || place[axis] > high_[axis]) return false;
      continue;
    }
    const double one = (low_[axis] - place[axis]) / to_sun[axis],
                 other = (high_[axis] - place[axis]) / to_sun[axis];
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
  }
  return begin < end;
}

std::optional<Eigen::Vector3d> FindSun(std::span<const ShadeSample> samples,
                                       const WheelbaseFootprint& contact) {
  const ShadeCaster car(contact);
  if (samples.size() < 2 * kMinShaded || contact.wheelbase <= 0 || contact.track <= 0) return {};
  std::vector<std::pair<double, double>> directions;  // azimuth, elevation [degrees]
  for (int i = 0; i < kNumAzimuths; ++i)
    for (int k = 0; k < kNumElevations; ++k)
      directions.emplace_back(360.0 * i / kNumAzimuths, kLowest + kElevationStep * k);
  const auto best_of = [&](const std::vector<std::pair<double, double>>& tried) {
    const std::vector<Match> matches = ParallelMap(tried.size(), [&](std::size_t i) {
      return MatchOf(samples, car, Direction(tried[i].first, tried[i].second));
    });
    const auto best = std::max_element(
        matches.begin(), matches.end(),
        [](const Match& a, const Match& b) { return a.correlation < b.correlation; });
    return std::pair(tried[static_cast<std::size_t>(best - matches.begin())], *best);
  };
  const auto [coarse, ignored] = best_of(directions);
  directions.clear();
  for (int i = -kNumFine; i <= kNumFine; ++i)
    for (int k = -kNumFine; k <= kNumFine; ++k)
      directions.emplace_back(coarse.first + i, coarse.second + k);
  const auto [fine, match] = best_of(directions);
  if (match.num_shaded < kMinShaded || match.darkness < kMinDarkness ||
      match.correlation < kMinMatch)
    return {};
  return Direction(fine.first, fine.second);
}

}  // namespace parkade

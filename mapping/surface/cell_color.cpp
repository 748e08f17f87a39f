#include "mapping/surface/cell_color.h"

#include <algorithm>
#include <utility>

#include "mapping/ground/image_sampling.h"

namespace parkade {
namespace {

constexpr int kColorTolerance =
    30;  // of lightness; observations further off the median are not averaged

}  // namespace

void CellColor::Add(const ColorObservation& observation, bool is_first) {
  if (is_first) nearest_.StepBack();
  nearest_.Add(observation);
}

std::uint8_t CellColor::Disagreement() const {
  int low = 255, high = 0;
  for (size_t i = 0; i < kNumObservations && nearest_[i].rank > 0; ++i) {
    const int lightness = Lightness(nearest_[i].blue, nearest_[i].green, nearest_[i].red);
    low = std::min(low, lightness);
    high = std::max(high, lightness);
  }
  return static_cast<std::uint8_t>(std::clamp(high - low, 0, 255));
}

std::array<std::uint8_t, 3> CellColor::Color() const {
  const size_t count = nearest_.CountComparable();
  if (count == 0) return {};
  std::array<std::pair<int, std::array<int, 3>>, kNumObservations> sorted;
  for (size_t i = 0; i < count; ++i) {
    const ColorObservation& observation = nearest_[i];
    sorted[i] = {Lightness(observation.blue, observation.green, observation.red),
                 {observation.blue, observation.green, observation.red}};
  }
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
  const int median = sorted[(count - 1) / 2].first;
  std::array<int, 3> sum{};
  int number = 0;
  for (size_t i = 0; i < count; ++i) {
    if (std::abs(sorted[i].first - median) > kColorTolerance) continue;
    for (size_t c = 0; c < 3; ++c) sum[c] += sorted[i].second[c];
    ++number;
  }
  const auto mean = [&](int value) {
    return static_cast<std::uint8_t>((value + number / 2) / number);
  };
  return {mean(sum[2]), mean(sum[1]), mean(sum[0])};
}

}  // namespace parkade

#include "mapping/cell_sights.h"

#include <algorithm>
#include <utility>

#include "mapping/image_sampling.h"

namespace parkade {
namespace {

constexpr int kAgeing = 8;           // a later drive over a cell makes sights so many times less near
constexpr int kComparable = 2;       // times nearer than another, a sight has a say alone
constexpr int kColorTolerance = 30;  // of lightness; sights further off the median are not averaged

}  // namespace

void CellSights::Add(const Sight& sight, bool is_first) {
  if (is_first)
    for (Sight& earlier : sights_)
      if (earlier.nearness > 0) earlier.nearness = static_cast<std::uint8_t>(std::max(1, earlier.nearness / kAgeing));
  if (sight.nearness <= sights_.back().nearness) return;
  size_t slot = sights_.size() - 1;
  for (; slot > 0 && sights_[slot - 1].nearness < sight.nearness; --slot) sights_[slot] = sights_[slot - 1];
  sights_[slot] = sight;
}

std::array<std::uint8_t, 3> CellSights::Color() const {
  std::array<std::pair<int, std::array<int, 3>>, std::tuple_size_v<decltype(sights_)>> sorted;
  size_t count = 0;
  for (const Sight& sight : sights_) {
    if (sight.nearness == 0 || kComparable * sight.nearness < sights_[0].nearness) break;
    const std::array<int, 3> bgr{sight.blue, sight.green, sight.red};
    sorted[count++] = {Lightness(sight.blue, sight.green, sight.red), bgr};
  }
  if (count == 0) return {};
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
  const int median = sorted[(count - 1) / 2].first;
  std::array<int, 3> sum{};
  int number = 0;
  for (size_t i = 0; i < count; ++i) {
    if (std::abs(sorted[i].first - median) > kColorTolerance) continue;
    for (size_t c = 0; c < 3; ++c) sum[c] += sorted[i].second[c];
    ++number;
  }
  const auto mean = [&](int value) { return static_cast<std::uint8_t>((value + number / 2) / number); };
  return {mean(sum[2]), mean(sum[1]), mean(sum[0])};
}

}  // namespace parkade

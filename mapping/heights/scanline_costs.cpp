#include "mapping/heights/scanline_costs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "mapping/ground/patch_index.h"

namespace parkade {
namespace {

constexpr int kNone = PatchIndex::kNone;
constexpr double kDeckHeight = 1.0;  // [m]

struct Direction {
  int dx = 0, dy = 0;
};
/// One of each pair of opposite directions: its windows come in the order of the grid.
constexpr std::array<Direction, 4> kDirections{{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};

/// The number of the window before each one in a direction, or kNone.
std::vector<int> FindBefore(std::span<const GridPlace> places, const PatchIndex& index,
                            const Direction& direction) {
  std::vector<int> before;
  for (const GridPlace& place : places) {
    int nearest = kNone;
    double least = kDeckHeight;
    for (int other = index.First(place.x - direction.dx, place.y - direction.dy); other != kNone;
         other = index.Next(other)) {
      const double distance =
          std::abs(places[static_cast<std::size_t>(other)].height - place.height);
      if (distance < least) nearest = other, least = distance;
    }
    before.push_back(nearest);
  }
  return before;
}

/// Sums along one direction, forward or back.
class Scan {
 public:
  Scan(std::span<const float> costs, std::size_t num_heights, const StepPenalties& penalties)
      : costs_(costs), num_heights_(num_heights), penalties_(penalties), sums_(costs.size()) {}

  void Start(std::size_t at) {
    const auto from = costs_.begin() + static_cast<std::ptrdiff_t>(at * num_heights_);
    std::copy(from, from + static_cast<std::ptrdiff_t>(num_heights_), Row(at));
  }

  void Continue(std::size_t at, std::size_t before) {
    const float* from = Row(before);
    const float least = *std::min_element(from, from + num_heights_);
    float* to = Row(at);
    const float* own = &costs_[at * num_heights_];
    for (std::size_t h = 0; h < num_heights_; ++h) {
      float best = least + penalties_.most;
      for (std::size_t step = 0;; ++step) {
        const float penalty = penalties_.per_step * static_cast<float>(step);
        if (penalty >= penalties_.most) break;
        if (h >= step) best = std::min(best, from[h - step] + penalty);
        if (h + step < num_heights_) best = std::min(best, from[h + step] + penalty);
      }
      to[h] = own[h] + best - least;
    }
  }

  const std::vector<float>& sums() const { return sums_; }

 private:
  float* Row(std::size_t at) { return &sums_[at * num_heights_]; }

  std::span<const float> costs_;
  std::size_t num_heights_;
  StepPenalties penalties_;
  std::vector<float> sums_;
};

}  // namespace

std::vector<float> SumAlongChains(std::span<const int> before, std::span<const float> costs,
                                  std::size_t num_heights, const StepPenalties& penalties) {
  const std::size_t count = before.size();
  std::vector<int> after(count, kNone);
  for (std::size_t i = 0; i < count; ++i)
    if (before[i] != kNone) after[static_cast<std::size_t>(before[i])] = static_cast<int>(i);
  std::vector<float> total(costs.size());
  for (std::size_t i = 0; i < costs.size(); ++i) total[i] = -costs[i];
  for (const bool is_forward : {true, false}) {
    Scan scan(costs, num_heights, penalties);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = is_forward ? k : count - 1 - k;
      const int from = is_forward ? before[i] : after[i];
      if (from == kNone)
        scan.Start(i);
      else
        scan.Continue(i, static_cast<std::size_t>(from));
    }
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += scan.sums()[i];
  }
  return total;
}

HeightBelief BeliefOf(std::span<const float> costs, std::span<const float> heights) {
  double weight = 0, sum = 0, square = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const double likelihood = std::exp(-static_cast<double>(costs[i])),
                 height = static_cast<double>(heights[i]);
    weight += likelihood, sum += likelihood * height, square += likelihood * height * height;
  }
  const double mean = sum / weight;
  return {mean, std::sqrt(std::max(0.0, square / weight - mean * mean))};
}

float EvidenceOf(std::span<const float> costs) {
  const auto [least, most] = std::minmax_element(costs.begin(), costs.end());
  return *most - *least;
}

void SubtractLeast(std::span<float> costs, std::size_t num_heights) {
  ParallelFor(costs.size() / num_heights, [&](std::size_t i) {
    const std::span<float> row = costs.subspan(i * num_heights, num_heights);
    const float least = *std::min_element(row.begin(), row.end());
    for (float& cost : row) cost -= least;
  });
}

std::vector<float> SumAlongScanlines(std::span<const GridPlace> places,
                                     std::span<const float> costs, std::size_t num_heights,
                                     const StepPenalties& penalties) {
  std::vector<float> total(costs.size());
  for (std::size_t i = 0; i < costs.size(); ++i) total[i] = -3 * costs[i];  // of four directions
  PatchIndex index;
  for (const GridPlace& place : places) index.Add(place.x, place.y);
  for (const Direction& direction : kDirections) {
    const std::vector<float> sums =
        SumAlongChains(FindBefore(places, index, direction), costs, num_heights, penalties);
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += sums[i];
  }
  SubtractLeast(total, num_heights);
  return total;
}

}  // namespace parkade

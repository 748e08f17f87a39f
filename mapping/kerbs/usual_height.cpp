#include "mapping/kerbs/usual_height.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mapping/kerbs/kerb_steps.h"

namespace parkade {
namespace {

constexpr double kKnown = 0.02;        // [m] sigma up to which others may lean on a height
constexpr double kNearby = 60;         // [m]
constexpr double kMinLength = 5;       // [m] of kerbs to lean on
constexpr double kLeastSigma = 0.015;  // [m] by which kerbs differ that stand beside each other

struct Height {
  double mean = 0, sigma = 0;  ///< [m]
};

/// The value in the middle of a total weight.
double WeightedMedian(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double total = 0, sum = 0;
  for (const auto& [value, weight] : values) total += weight;
  for (const auto& [value, weight] : values)
    if ((sum += weight) >= 0.5 * total) return value;
  return values.back().first;
}

/// How high kerbs near a place are, by length.
std::optional<Height> UsualNear(const Eigen::Vector3d& place, const std::vector<Kerb>& kerbs) {
  std::vector<std::pair<double, double>> heights;
  double length = 0;
  for (const Kerb& kerb : kerbs) {
    if (kerb.height_sigma > kKnown) continue;
    if ((kerb.points[kerb.points.size() / 2] - place).norm() > kNearby) continue;
    heights.emplace_back(kerb.height, kerb.Length());
    length += kerb.Length();
  }
  if (length < kMinLength) return {};
  const double mean = WeightedMedian(heights);
  double square = 0;
  for (const auto& [height, weight] : heights) square += weight * (height - mean) * (height - mean);
  return Height{mean, std::max(kLeastSigma, std::sqrt(square / length))};
}

}  // namespace

void LeanOnNeighbors(std::vector<Kerb>& kerbs) {
  std::vector<std::optional<Height>> usual;
  usual.reserve(kerbs.size());
  for (const Kerb& kerb : kerbs)
    usual.push_back(kerb.height_sigma <= kKnown
                        ? std::nullopt
                        : UsualNear(kerb.points[kerb.points.size() / 2], kerbs));
  for (std::size_t i = 0; i < kerbs.size(); ++i) {
    if (!usual[i]) continue;
    Kerb& kerb = kerbs[i];
    // Its height is what was seen and what is usual anywhere; the latter gives way.
    constexpr double kAnywhere = 1 / (KerbStep::kUsualSigma * KerbStep::kUsualSigma);
    const double all = 1 / (kerb.height_sigma * kerb.height_sigma),
                 seen = std::max(0.0, all - kAnywhere),
                 usually = 1 / (usual[i]->sigma * usual[i]->sigma);
    const double seen_sum = seen > 0 ? all * kerb.height - kAnywhere * KerbStep::kUsual : 0;
    const auto [low, high] = std::minmax(kerb.height, usual[i]->mean);
    kerb.height = std::clamp((seen_sum + usually * usual[i]->mean) / (seen + usually), low, high);
    kerb.height_sigma = 1 / std::sqrt(seen + usually);
  }
}

}  // namespace parkade

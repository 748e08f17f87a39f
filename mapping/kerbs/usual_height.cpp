#include "mapping/kerbs/usual_height.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mapping/kerbs/kerb_steps.h"

namespace parkade {
namespace {

constexpr double kKnown = 0.02;   // [m] sigma up to which others may lean on a height
constexpr double kNearby = 60;    // [m]
constexpr double kMinLength = 5;  // [m] of kerbs to lean on; more of one kerb knows no more
constexpr double kAlike = 0.015;  // [m] sigma by which kerbs differ that stand beside each other
constexpr double kWithinSigma = 0.683;  // of a normal distribution

struct Height {
  double mean = 0, sigma = 0;  ///< [m]
};

const Eigen::Vector3d& MiddleOf(const Kerb& kerb) { return kerb.points[kerb.points.size() / 2]; }

/// The least value up to which a share of the total weight lies.
double WeightedQuantile(std::vector<std::pair<double, double>> values, double share) {
  std::sort(values.begin(), values.end());
  double total = 0, sum = 0;
  for (const auto& [value, weight] : values) total += weight;
  for (const auto& [value, weight] : values)
    if ((sum += weight) >= share * total) return value;
  return values.back().first;
}

/// How high the other kerbs near one are: each counts by what it knows of that, and bad ones are
/// outvoted.
std::optional<Height> UsualBeside(const Kerb& kerb, const std::vector<Kerb>& kerbs) {
  std::vector<std::pair<double, double>> votes;
  double length = 0, information = 0;
  for (const Kerb& other : kerbs) {
    if (&other == &kerb || other.height_sigma > kKnown) continue;
    if ((MiddleOf(other) - MiddleOf(kerb)).norm() > kNearby) continue;
    const double known = 1 / (other.height_sigma * other.height_sigma + kAlike * kAlike);
    votes.emplace_back(other.height, known * std::min(other.Length(), kMinLength));
    length += other.Length();
    information += known;
  }
  if (length < kMinLength) return {};
  const double median = WeightedQuantile(votes, 0.5);
  for (auto& [height, weight] : votes) height = std::abs(height - median);
  const double spread = std::max(kAlike, WeightedQuantile(votes, kWithinSigma));
  return Height{median, std::sqrt(spread * spread + 1 / information)};
}

}  // namespace

void LeanOnNeighbors(std::vector<Kerb>& kerbs) {
  std::vector<std::optional<Height>> usual;
  usual.reserve(kerbs.size());
  for (const Kerb& kerb : kerbs)
    usual.push_back(kerb.height_sigma <= kAlike ? std::nullopt : UsualBeside(kerb, kerbs));
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

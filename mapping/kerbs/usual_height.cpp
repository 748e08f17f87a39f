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
constexpr std::size_t kMinVotes = 5;    // from which on those that contradict are outvoted

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

/// By how much votes are off a height [m]: of many those that agree tell, of few all.
double SpreadOf(std::vector<std::pair<double, double>> votes, double height) {
  double square = 0, total = 0;
  for (auto& [value, weight] : votes) {
    value = std::abs(value - height);
    square += weight * value * value;
    total += weight;
  }
  return votes.size() < kMinVotes ? std::sqrt(square / total)
                                  : WeightedQuantile(std::move(votes), kWithinSigma);
}

/// How high the other kerbs near one are: each counts by what it knows of that.
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
  const double spread = std::max(kAlike, SpreadOf(votes, median));
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
    // Where both contradict each other, neither is as sure as it says (R. Birge, "The calculation
    // of errors by the method of least squares", Phys. Rev. 40, 1932).
    const double contradiction =
        seen > 0 ? std::abs(seen_sum / seen - usual[i]->mean) / std::sqrt(1 / seen + 1 / usually)
                 : 0;
    kerb.height = std::clamp((seen_sum + usually * usual[i]->mean) / (seen + usually), low, high);
    kerb.height_sigma = std::max(1.0, contradiction) / std::sqrt(seen + usually);
  }
}

}  // namespace parkade

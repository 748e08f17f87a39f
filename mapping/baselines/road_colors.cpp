#include "mapping/baselines/road_colors.h"

#include <algorithm>
#include <limits>

namespace parkade {
namespace {

constexpr int kNumClusters = 3;
constexpr int kNumRounds = 6;
constexpr double kMinShare = 0.1;  // of the seeds; a smaller cluster is not the road
const Appearance kMinSigma(7, 3, 3, 3);
const Appearance kMaxSigma(18, 6, 6, 8);
constexpr float kPaintContrast = 25;  // of lightness: brighter than this, any hue may be paint
constexpr float kPaintHue =
    10;  // of a and b: nearer than this, any brightness may be a line's edge

}  // namespace

RoadColors::RoadColors(const std::vector<Appearance>& seeds) {
  if (seeds.empty()) return;
  std::vector<Appearance> sorted = seeds;
  std::sort(sorted.begin(), sorted.end(), [](const Appearance& a, const Appearance& b) {
    return std::lexicographical_compare(a.data(), a.data() + 4, b.data(), b.data() + 4);
  });
  std::vector<Appearance> means;
  for (int k = 0; k < kNumClusters; ++k)
    means.push_back(sorted[sorted.size() * static_cast<size_t>(2 * k + 1) / (2 * kNumClusters)]);

  std::vector<Appearance> sums, square_sums;
  std::vector<float> counts;
  for (int round = 0; round < kNumRounds; ++round) {
    sums.assign(kNumClusters, Appearance::Zero());
    square_sums.assign(kNumClusters, Appearance::Zero());
    counts.assign(kNumClusters, 0);
    for (const Appearance& seed : sorted) {
      size_t nearest = 0;
      for (size_t k = 1; k < kNumClusters; ++k)
        if ((seed - means[k]).matrix().squaredNorm() <
            (seed - means[nearest]).matrix().squaredNorm())
          nearest = k;
      sums[nearest] += seed;
      square_sums[nearest] += seed.square();
      counts[nearest] += 1;
    }
    for (size_t k = 0; k < kNumClusters; ++k)
      if (counts[k] > 0) means[k] = sums[k] / counts[k];
  }
  const float min_count = static_cast<float>(kMinShare * static_cast<double>(seeds.size()));
  for (size_t k = 0; k < kNumClusters; ++k) {
    if (counts[k] < min_count) continue;
    const Appearance variance = (square_sums[k] / counts[k] - means[k].square()).max(0);
    clusters_.push_back({means[k], variance.sqrt().max(kMinSigma).min(kMaxSigma).inverse()});
  }
}

float RoadColors::DistanceTo(const Appearance& appearance) const {
  float nearest = std::numeric_limits<float>::max();
  for (const Cluster& cluster : clusters_)
    nearest =
        std::min(nearest, ((appearance - cluster.mean) * cluster.inverse_sigma).matrix().norm());
  return nearest;
}

bool RoadColors::MayBePaint(const Appearance& appearance) const {
  return std::any_of(clusters_.begin(), clusters_.end(), [&](const Cluster& cluster) {
    const float brighter = appearance[0] - cluster.mean[0];
    const float hue = (appearance - cluster.mean).segment<2>(1).matrix().norm();
    return brighter > kPaintContrast || (brighter > -kMinSigma[0] && hue < kPaintHue);
  });
}

}  // namespace parkade

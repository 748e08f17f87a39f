#include "mapping/texture/balance_light.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <span>

namespace parkade {
namespace {

constexpr double kPriorWeight = 5;    // of a photo's gain, where a steep sight has 1: a few sights do not move it
constexpr double kFalloffWeight = 1;  // of a lens without any
constexpr double kTolerance = 0.06;   // of log-colours: sights further off count a half or less
constexpr int kNumRounds = 4;         // of reweighting
constexpr float kMinWeight = 1e-6F;

using SparseMatrix = Eigen::SparseMatrix<double>;
using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

std::span<const LightSight> SightsOf(const LightPlace& place) {
  const auto& sights = place.sights();
  const auto end = std::find_if(sights.begin(), sights.end(), [](const LightSight& one) { return one.weight <= 0; });
  return {sights.begin(), end};
}

/// What is added to a sight's log-colour: its photo's gain and twice its lens's falloff, by powers of the radius.
struct Terms {
  std::array<int, 3> index;
  std::array<double, 3> factor;
};

class Balance {
 public:
  Balance(const std::vector<LightPrior>& photos, const std::vector<LightPlace>& places)
      : photos_(&photos), places_(&places) {
    for (const LightPrior& photo : photos) num_lenses_ = std::max(num_lenses_, photo.lens + 1);
    unknowns_ = Unknowns::Zero(static_cast<Eigen::Index>(photos.size() + 2 * std::size_t{num_lenses_}), 3);
    for (std::size_t i = 0; i < photos.size(); ++i)
      unknowns_.row(static_cast<Eigen::Index>(i)) = photos[i].log_gain.cast<double>().transpose();
  }

  BalancedLight Solve() {
    for (int round = 0; round < kNumRounds; ++round) Step();
    BalancedLight light;
    const auto row = [&](std::size_t i) -> Eigen::Array3f {
      return unknowns_.row(static_cast<Eigen::Index>(i)).transpose().cast<float>().array();
    };
    for (std::size_t i = 0; i < photos_->size(); ++i) light.gains.push_back(row(i).exp());
    for (std::size_t lens = 0; lens < num_lenses_; ++lens)
      light.falloffs.push_back({row(photos_->size() + 2 * lens), row(photos_->size() + 2 * lens + 1)});
    return light;
  }

 private:
  Terms TermsOf(const LightSight& sight) const {
    const std::size_t lens = photos_->size() + 2 * std::size_t{(*photos_)[sight.photo].lens};
    const double square = static_cast<double>(sight.squared_radius);
    return {{static_cast<int>(sight.photo), static_cast<int>(lens), static_cast<int>(lens) + 1},
            {1, square, square * square}};
  }

  Eigen::RowVector3d Corrected(const LightSight& sight, const Terms& terms) const {
    Eigen::RowVector3d color = sight.log_color.cast<double>().matrix().transpose();
    for (std::size_t i = 0; i < 3; ++i) color += terms.factor[i] * unknowns_.row(terms.index[i]);
    return color;
  }

  void Step() {
    const auto size = unknowns_.rows();
    std::vector<Eigen::Triplet<double>> entries;
    Unknowns right = Unknowns::Zero(size, 3);
    for (Eigen::Index i = 0; i < size; ++i) {
      const bool is_photo = i < static_cast<Eigen::Index>(photos_->size());
      const double weight = is_photo ? kPriorWeight : kFalloffWeight;
      entries.emplace_back(i, i, weight);
      if (is_photo)
        right.row(i) = weight * (*photos_)[static_cast<std::size_t>(i)].log_gain.cast<double>().matrix().transpose();
    }
    for (const LightPlace& place : *places_) AddPlace(SightsOf(place), entries, right);
    SparseMatrix normal(size, size);
    normal.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<SparseMatrix> solver(normal);
    unknowns_ = solver.solve(right);
  }

  /// Sum of w (l + a x - mean)^2, the mean being the place's own log-colour.
  void AddPlace(std::span<const LightSight> sights, std::vector<Eigen::Triplet<double>>& entries,
                Unknowns& right) const {
    if (sights.size() < 2) return;
    std::array<Terms, LightPlace::kNumSights> terms;
    std::array<double, LightPlace::kNumSights> weights{};
    std::array<Eigen::RowVector3d, LightPlace::kNumSights> corrected;
    std::array<double, LightPlace::kNumSights> sorted{};
    for (std::size_t i = 0; i < sights.size(); ++i) {
      terms[i] = TermsOf(sights[i]);
      corrected[i] = Corrected(sights[i], terms[i]);
      sorted[i] = corrected[i].sum() / 3;
    }
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sights.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(sights.size()));
    double total = 0;
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const double off = (corrected[i].sum() / 3 - *middle) / kTolerance;
      weights[i] = static_cast<double>(sights[i].weight) / (1 + off * off);
      total += weights[i];
      mean += weights[i] * sights[i].log_color.cast<double>().matrix().transpose();
    }
    mean /= total;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const Eigen::RowVector3d off = sights[i].log_color.cast<double>().matrix().transpose() - mean;
      for (std::size_t a = 0; a < 3; ++a) {
        right.row(terms[i].index[a]) -= weights[i] * terms[i].factor[a] * off;
        for (std::size_t k = 0; k < sights.size(); ++k) {
          const double weight = (i == k ? weights[i] : 0) - weights[i] * weights[k] / total;
          for (std::size_t b = 0; b < 3; ++b)
            entries.emplace_back(terms[i].index[a], terms[k].index[b],
                                 weight * terms[i].factor[a] * terms[k].factor[b]);
        }
      }
    }
  }

  const std::vector<LightPrior>* photos_;
  const std::vector<LightPlace>* places_;
  std::uint32_t num_lenses_ = 0;
  Unknowns unknowns_;  // log-gain per photo, then two of the falloff per lens
};

}  // namespace

void LightPlace::Add(const LightSight& sight) {
  if (sight.weight < kMinWeight || sight.weight <= sights_.back().weight) return;
  std::size_t slot = kNumSights - 1;
  for (; slot > 0 && sights_[slot - 1].weight < sight.weight; --slot) sights_[slot] = sights_[slot - 1];
  sights_[slot] = sight;
}

BalancedLight BalanceLight(const std::vector<LightPrior>& photos, const std::vector<LightPlace>& places) {
  if (photos.empty()) return {};
  return Balance(photos, places).Solve();
}

double LightDisagreement(const std::vector<LightPrior>& photos, const std::vector<LightPlace>& places,
                         const BalancedLight& light) {
  double sum = 0, total = 0;
  for (const LightPlace& place : places) {
    const auto sights = SightsOf(place);
    if (sights.size() < 2) continue;
    std::array<double, LightPlace::kNumSights> values{};
    double mean = 0, weight = 0;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const LightSight& sight = sights[i];
      const PhotoLight::Falloff& falloff = light.falloffs[photos[sight.photo].lens];
      const Eigen::Array3f log_color = sight.log_color + light.gains[sight.photo].log() +
                                       sight.squared_radius * falloff[0] +
                                       sight.squared_radius * sight.squared_radius * falloff[1];
      values[i] = static_cast<double>(log_color.mean());
      mean += static_cast<double>(sight.weight) * values[i];
      weight += static_cast<double>(sight.weight);
    }
    mean /= weight;
    for (std::size_t i = 0; i < sights.size(); ++i)
      sum += static_cast<double>(sights[i].weight) * (values[i] - mean) * (values[i] - mean);
    total += weight;
  }
  return total > 0 ? std::sqrt(sum / total) : 0;
}

}  // namespace parkade

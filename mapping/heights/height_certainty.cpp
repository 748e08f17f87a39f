#include "mapping/heights/height_certainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>
#include <tuple>
#include <vector>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kScatterShare =
    0.5;  // what views have in common, as poses, makes the mean err, too
constexpr double kKnownSigma = 0.03;                   // [m] of a patch whose height was measured
constexpr double kBase = 2.0;                          // [m] over which a slope is taken
constexpr std::array<double, 4> kLengths{2, 4, 6, 8};  // [m] of continuation that are tried
constexpr size_t kMinTrials = 100;
constexpr double kShare =
    0.95;  // of the trials that err by less than kSigmas sigmas, as a Gaussian would have it
constexpr double kSigmas = 1.96;
constexpr double kUnknownSlope = 0.005;      // [rad] where it could not be tried
constexpr double kUnknownCurvature = 0.007;  // [1/m]

/// A place on the field.
struct Place {
  int patch = HeightField::kNone;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< [m] the middle of the patch
};

class SigmaSpreader {
 public:
  explicit SigmaSpreader(HeightField& field) : field_(&field) {
    is_known_.resize(static_cast<size_t>(field.num_patches()));
    for (int patch = 0; patch < field.num_patches(); ++patch)
      is_known_[static_cast<size_t>(patch)] = field.SigmaOf(patch) <= kKnownSigma;
  }

  void Spread() {
    LearnGrowth();
    using Reached = std::tuple<double, int, double,
                               double>;  // distance [m], patch, sigma and bend where it started
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
    std::vector<bool> is_done(is_known_.size());
    for (int patch = 0; patch < field_->num_patches(); ++patch)
      if (is_known_[static_cast<size_t>(patch)])
        open.emplace(0, patch, field_->SigmaOf(patch), BendAt(PlaceOf(patch)));
    while (!open.empty()) {
      const auto [distance, patch, sigma, bend] = open.top();
      open.pop();
      if (is_done[static_cast<size_t>(patch)]) continue;
      is_done[static_cast<size_t>(patch)] = true;
      field_->SetSigma(patch,
                       std::min(field_->SigmaOf(patch),
                                std::hypot(sigma, std::max(GrowthAt(distance),
                                                           0.5 * bend * distance * distance))));
      const Place here = PlaceOf(patch);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int next = Step(here, {dx * field_->spacing(), dy * field_->spacing()}).patch;
          if (next != HeightField::kNone && !is_done[static_cast<size_t>(next)])
            open.emplace(distance + field_->spacing() * std::hypot(dx, dy), next, sigma, bend);
        }
    }
  }

 private:
  Place PlaceOf(int patch) const {
    const Eigen::Vector2d middle =
        (field_->IndexOf(patch).cast<double>().array() + 0.5) * field_->spacing();
    return {patch, {middle.x(), middle.y(), field_->HeightAt(patch, middle)}};
  }

  Place Step(const Place& from, const Eigen::Vector2d& step) const {
    Place to{HeightField::kNone, from.point + Eigen::Vector3d(step.x(), step.y(), 0)};
    to.patch = field_->FindPatch(to.point, to.point.z());
    return to;
  }

  std::optional<double> KnownHeight(const Place& from, const Eigen::Vector2d& step) const {
    const Place there = Step(from, step);
    if (there.patch == HeightField::kNone || !is_known_[static_cast<size_t>(there.patch)])
      return std::nullopt;
    return there.point.z();
  }

  /// [1/m] how much the ground bends there: a ramp goes on less far than a deck.
  double BendAt(const Place& here) const {
    double bend = 0;
    for (const Eigen::Vector2d& along : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)}) {
      const Place before = Step(here, -kBase * along), after = Step(here, kBase * along);
      if (before.patch == HeightField::kNone || after.patch == HeightField::kNone) continue;
      bend = std::max(bend, std::abs(before.point.z() - 2 * here.point.z() + after.point.z()) /
                                (kBase * kBase));
    }
    return bend;
  }

  /// Continues the slope between two known places to a third one, wherever there are three in a
  /// row.
  void LearnGrowth() {
    std::array<std::vector<double>, kLengths.size()> errors;
    for (int patch = 0; patch < field_->num_patches(); ++patch) {
      if (!is_known_[static_cast<size_t>(patch)]) continue;
      const Place here = PlaceOf(patch);
      for (const Eigen::Vector2d& along : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1),
                                           Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, -1)}) {
        const std::optional<double> before = KnownHeight(here, -kBase * along);
        if (!before) continue;
        const double slope = (here.point.z() - *before) / kBase;
        for (size_t i = 0; i < kLengths.size(); ++i)
          if (const std::optional<double> there = KnownHeight(here, kLengths[i] * along))
            errors[i].push_back(std::abs(*there - here.point.z() - slope * kLengths[i]));
      }
    }
    double least = 0;
    for (size_t i = 0; i < kLengths.size(); ++i) {
      growth_[i] = std::hypot(kUnknownSlope * kLengths[i],
                              0.5 * kUnknownCurvature * kLengths[i] * kLengths[i]);
      if (errors[i].size() >= kMinTrials) {
        const auto rank = static_cast<size_t>(kShare * static_cast<double>(errors[i].size()));
        growth_[i] = NthSmallest(errors[i], rank) / kSigmas;
      }
      least = growth_[i] = std::max(least, growth_[i]);
    }
  }

  /// [m] one sigma of what continuing the surface over a distance costs.
  double GrowthAt(double distance) const {
    if (distance >= kLengths.back())
      return growth_.back() * std::pow(distance / kLengths.back(), 2);
    double from = 0, sigma = 0;
    for (size_t i = 0; i < kLengths.size(); ++i) {
      if (distance <= kLengths[i])
        return sigma + (growth_[i] - sigma) * (distance - from) / (kLengths[i] - from);
      from = kLengths[i], sigma = growth_[i];
    }
    return sigma;
  }

  HeightField* field_;
  std::vector<bool> is_known_;
  std::array<double, kLengths.size()> growth_{};
};

}  // namespace

void AddScatter(std::span<const HeightObservation> observations, HeightField& field) {
  struct Scatter {
    double squares = 0, weight = 0;
  };
  std::vector<Scatter> scatters(static_cast<size_t>(field.num_patches()));
  for (const HeightObservation& observation : observations) {
    double height = 0;
    const int patch = field.FindPatch(observation.point_in_site, height);
    if (patch == HeightField::kNone) continue;
    const double off = observation.point_in_site.z() - height, weight = field.WeightOf(observation);
    Scatter& scatter = scatters[static_cast<size_t>(patch)];
    scatter.squares += weight * off * off;
    scatter.weight += weight;
  }
  for (int patch = 0; patch < field.num_patches(); ++patch)
    if (const Scatter& scatter = scatters[static_cast<size_t>(patch)]; scatter.weight > 0)
      field.SetSigma(patch,
                     std::hypot(field.SigmaOf(patch),
                                kScatterShare * std::sqrt(scatter.squares / scatter.weight)));
}

void SpreadSigmas(HeightField& field) { SigmaSpreader(field).Spread(); }

}  // namespace parkade

#include "mapping/texture/calibrate_photometry.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <span>

namespace parkade {
namespace {

constexpr double kPriorWeight =
    5;  // of an image's gain, where a steep observation has 1: a few observations do not move it
constexpr double kFalloffWeight = 1;  // of a lens without any
constexpr double kTolerance = 0.06;  // of log-colors: observations further off count a half or less
constexpr int kNumRounds = 4;        // of reweighting
constexpr float kMinWeight = 1e-6F;

using SparseMatrix = Eigen::SparseMatrix<double>;
using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

std::span<const LightObservation> ObservationsOf(const LightPlace& place) {
  const auto& observations = place.observations();
  const auto end = std::find_if(observations.begin(), observations.end(),
                                [](const LightObservation& one) { return one.weight <= 0; });
  return {observations.begin(), end};
}

/// What is added to an observation's log-color: its image's gain and twice its lens's falloff, by
/// powers of the radius.
struct Terms {
  std::array<int, 3> index;
  std::array<double, 3> factor;
};

class Balance {
 public:
  Balance(const std::vector<LightPrior>& images, const std::vector<LightPlace>& places)
      : images_(&images), places_(&places) {
    for (const LightPrior& image : images) num_lenses_ = std::max(num_lenses_, image.lens + 1);
    unknowns_ =
        Unknowns::Zero(static_cast<Eigen::Index>(images.size() + 2 * std::size_t{num_lenses_}), 3);
    for (std::size_t i = 0; i < images.size(); ++i)
      unknowns_.row(static_cast<Eigen::Index>(i)) = images[i].log_gain.cast<double>().transpose();
  }

  PhotometricCalibration Solve() {
    for (int round = 0; round < kNumRounds; ++round) Step();
    PhotometricCalibration light;
    const auto row = [&](std::size_t i) -> Eigen::Array3f {
      return unknowns_.row(static_cast<Eigen::Index>(i)).transpose().cast<float>().array();
    };
    for (std::size_t i = 0; i < images_->size(); ++i) light.gains.push_back(row(i).exp());
    for (std::size_t lens = 0; lens < num_lenses_; ++lens)
      light.falloffs.push_back(
          {row(images_->size() + 2 * lens), row(images_->size() + 2 * lens + 1)});
    return light;
  }

 private:
  Terms TermsOf(const LightObservation& observation) const {
    const std::size_t lens = images_->size() + 2 * std::size_t{(*images_)[observation.image].lens};
    const double square = static_cast<double>(observation.squared_radius);
    return {
        {static_cast<int>(observation.image), static_cast<int>(lens), static_cast<int>(lens) + 1},
        {1, square, square * square}};
  }

  Eigen::RowVector3d Corrected(const LightObservation& observation, const Terms& terms) const {
    Eigen::RowVector3d color = observation.log_color.cast<double>().matrix().transpose();
    for (std::size_t i = 0; i < 3; ++i) color += terms.factor[i] * unknowns_.row(terms.index[i]);
    return color;
  }

  void Step() {
    const auto size = unknowns_.rows();
    std::vector<Eigen::Triplet<double>> entries;
    Unknowns right = Unknowns::Zero(size, 3);
    for (Eigen::Index i = 0; i < size; ++i) {
      const bool is_image = i < static_cast<Eigen::Index>(images_->size());
      const double weight = is_image ? kPriorWeight : kFalloffWeight;
      entries.emplace_back(i, i, weight);
      if (is_image)
        right.row(i) =
            weight *
            (*images_)[static_cast<std::size_t>(i)].log_gain.cast<double>().matrix().transpose();
    }
    for (const LightPlace& place : *places_) AddPlace(ObservationsOf(place), entries, right);
    SparseMatrix normal(size, size);
    normal.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<SparseMatrix> solver(normal);
    unknowns_ = solver.solve(right);
  }

  /// Sum of w (l + a x - mean)^2, the mean being the place's own log-color.
  void AddPlace(std::span<const LightObservation> observations,
                std::vector<Eigen::Triplet<double>>& entries, Unknowns& right) const {
    if (observations.size() < 2) return;
    std::array<Terms, LightPlace::kNumObservations> terms;
    std::array<double, LightPlace::kNumObservations> weights{};
    std::array<Eigen::RowVector3d, LightPlace::kNumObservations> corrected;
    std::array<double, LightPlace::kNumObservations> sorted{};
    for (std::size_t i = 0; i < observations.size(); ++i) {
      terms[i] = TermsOf(observations[i]);
      corrected[i] = Corrected(observations[i], terms[i]);
      sorted[i] = corrected[i].sum() / 3;
    }
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(observations.size() / 2);
    std::nth_element(sorted.begin(), middle,
                     sorted.begin() + static_cast<std::ptrdiff_t>(observations.size()));
    double total = 0;
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const double off = (corrected[i].sum() / 3 - *middle) / kTolerance;
      weights[i] = static_cast<double>(observations[i].weight) / (1 + off * off);
      total += weights[i];
      mean += weights[i] * observations[i].log_color.cast<double>().matrix().transpose();
    }
    mean /= total;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const Eigen::RowVector3d off =
          observations[i].log_color.cast<double>().matrix().transpose() - mean;
      for (std::size_t a = 0; a < 3; ++a) {
        right.row(terms[i].index[a]) -= weights[i] * terms[i].factor[a] * off;
        for (std::size_t k = 0; k < observations.size(); ++k) {
          const double weight = (i == k ? weights[i] : 0) - weights[i] * weights[k] / total;
          for (std::size_t b = 0; b < 3; ++b)
            entries.emplace_back(terms[i].index[a], terms[k].index[b],
                                 weight * terms[i].factor[a] * terms[k].factor[b]);
        }
      }
    }
  }

  const std::vector<LightPrior>* images_;
  const std::vector<LightPlace>* places_;
  std::uint32_t num_lenses_ = 0;
  Unknowns unknowns_;  // log-gain per image, then two of the falloff per lens
};

}  // namespace

void LightPlace::Add(const LightObservation& observation) {
  if (observation.weight < kMinWeight || observation.weight <= observations_.back().weight) return;
  std::size_t slot = kNumObservations - 1;
  for (; slot > 0 && observations_[slot - 1].weight < observation.weight; --slot)
    observations_[slot] = observations_[slot - 1];
  observations_[slot] = observation;
}

PhotometricCalibration CalibratePhotometry(const std::vector<LightPrior>& images,
                                           const std::vector<LightPlace>& places) {
  if (images.empty()) return {};
  return Balance(images, places).Solve();
}

double LightDisagreement(const std::vector<LightPrior>& images,
                         const std::vector<LightPlace>& places,
                         const PhotometricCalibration& light) {
  double sum = 0, total = 0;
  for (const LightPlace& place : places) {
    const auto observations = ObservationsOf(place);
    if (observations.size() < 2) continue;
    std::array<double, LightPlace::kNumObservations> values{};
    double mean = 0, weight = 0;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const LightObservation& observation = observations[i];
      const ExposureAndVignetting::Falloff& falloff =
          light.falloffs[images[observation.image].lens];
      const Eigen::Array3f log_color =
          observation.log_color + light.gains[observation.image].log() +
          observation.squared_radius * falloff[0] +
          observation.squared_radius * observation.squared_radius * falloff[1];
      values[i] = static_cast<double>(log_color.mean());
      mean += static_cast<double>(observation.weight) * values[i];
      weight += static_cast<double>(observation.weight);
    }
    mean /= weight;
    for (std::size_t i = 0; i < observations.size(); ++i)
      sum += static_cast<double>(observations[i].weight) * (values[i] - mean) * (values[i] - mean);
    total += weight;
  }
  return total > 0 ? std::sqrt(sum / total) : 0;
}

}  // namespace parkade

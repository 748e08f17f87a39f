#include "mapping/heights/plane_heights.h"

#include <algorithm>
#include <cmath>

#include "core/math/fast_floor.h"
#include "core/parallel.h"
#include "mapping/ground/isometry_of.h"

namespace parkade {
namespace {

constexpr double kLeastPlaneVariance =
    4e-4;  // [m^2] of a keyframe's plane: wheels and the sweep are surer
constexpr size_t kPatchesPerBatch = 64;  // in memory at once

}  // namespace

void PlaneHeights::Sum::Add(const Eigen::Vector3d& at, double its_weight, double its_best_weight) {
  point += its_weight * at;
  square += its_weight * at.z() * at.z();
  weight += its_weight;
  best_weight = std::max(best_weight, its_best_weight);
}

double PlaneHeights::Sum::SureWeight() const {
  const double height = point.z() / weight, spread = square / weight - height * height;
  return 1 / std::max(1 / best_weight, spread);
}

PlaneHeights::Square PlaneHeights::SquareOf(const Eigen::Vector3d& point) const {
  return {FastFloor(point.z() * levels_per_meter_), FastFloor(point.y() * squares_per_meter_),
          FastFloor(point.x() * squares_per_meter_)};
}

void PlaneHeights::Add(const PosedGroundPatch& posed, const DrivenPath* path) {
  const Eigen::Isometry3d site_from_body = IsometryOf(posed.site_from_body);
  const Eigen::Isometry3d ground_from_body =
      IsometryOf(path ? path->body_from_ground.Inverse() : Rigid3{});
  const Eigen::Vector2d acceleration =
      path ? AccelerationAt(path->site_from_body, posed.patch.time) : Eigen::Vector2d::Zero();
  const double share = path ? path->plane_errors * path->plane_errors : 1;
  Square last;
  Sum* here = nullptr;  // samples that follow each other mostly lie in one square
  for (const GroundSample& sample : posed.patch.samples) {
    if (!sample.is_free) continue;
    const Eigen::Vector3d point_in_body = sample.point_in_body.cast<double>();
    Eigen::Vector3d point = site_from_body * point_in_body;
    if (path)
      point.z() -= path->lean.LiftAt(acceleration, (ground_from_body * point_in_body).head<2>());
    const Square square = SquareOf(point);
    if (here == nullptr || square != last) here = &sums_[square], last = square;
    // Among planes that disagree the nearest car's is right, however well they agree elsewhere.
    const auto weight = static_cast<double>(sample.weight), sureness = kLeastPlaneVariance * weight;
    here->Add(point, weight / (1 + sureness), weight / (share + sureness));
  }
}

void PlaneHeights::Merge(const PlaneHeights& other) {
  for (const auto& [square, sum] : other.sums_) {
    Sum& here = sums_[square];
    here.point += sum.point;
    here.square += sum.square;
    here.weight += sum.weight;
    here.best_weight = std::max(here.best_weight, sum.best_weight);
  }
}

std::vector<HeightObservation> PlaneHeights::Sums() const {
  std::vector<HeightObservation> sums;
  sums.reserve(sums_.size());
  for (const auto& [square, sum] : sums_)
    sums.push_back({sum.point / sum.weight, sum.weight, 1 / std::sqrt(sum.SureWeight())});
  return sums;
}

std::vector<HeightObservation> PlaneHeights::Observations(double share) const {
  std::vector<HeightObservation> observations;
  observations.reserve(sums_.size());
  for (const auto& [square, sum] : sums_)
    observations.push_back({sum.point / sum.weight, share * sum.SureWeight()});
  return observations;
}

PlaneHeights CollectPlanes(const PatchSource& patches, const DrivenPath* path,
                           const HeightFieldOptions& options) {
  PlaneHeights planes(options);
  const size_t count = patches.views().size();
  for (size_t begin = 0; begin < count; begin += kPatchesPerBatch) {
    const auto of_patches = ParallelMap(std::min(kPatchesPerBatch, count - begin), [&](size_t i) {
      PlaneHeights heights(options);
      heights.Add(patches.Read(begin + i), path);
      return heights;
    });
    for (const PlaneHeights& heights : of_patches) planes.Merge(heights);
  }
  return planes;
}

}  // namespace parkade

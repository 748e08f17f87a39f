#pragma once

#include <Eigen/Core>
#include <map>
#include <tuple>
#include <vector>

#include "core/ground_patch.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/height_field.h"

namespace parkade {

/// The heights at which patches put the ground: the planes that their cars stood on. Sums per
/// square of the field and deck.
class PlaneHeights {
 public:
  explicit PlaneHeights(const HeightFieldOptions& options = {})
      : squares_per_meter_(1 / options.spacing), levels_per_meter_(1 / options.level_separation) {}

  /// `path` is that of its drive, or null.
  void Add(const PosedGroundPatch& posed, const DrivenPath* path);

  /// Planes of one square that somebody summed up. Weights [1/m^2]: of all, and of the best.
  void Add(const Eigen::Vector3d& point, double weight, double best_weight) {
    sums_[SquareOf(point)].Add(point, weight, best_weight);
  }

  void Merge(const PlaneHeights& other);

  /// One per square and deck: their mean, with the weight of all of them and the sigma of the mean.
  std::vector<HeightObservation> Sums() const;

  /// Also, with `share` of the weight that the sigma stands for.
  std::vector<HeightObservation> Observations(double share) const;

 private:
  using Square = std::tuple<int, int, int>;  ///< deck, y, x

  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double square = 0;  ///< of heights
    double weight = 0, best_weight = 0;

    void Add(const Eigen::Vector3d& at, double its_weight, double its_best_weight);

    /// [1/m^2] that of the best plane, unless planes disagree: where a ramp begins, cars on the
    /// flat before it know nothing of it.
    double SureWeight() const;
  };

  Square SquareOf(const Eigen::Vector3d& point) const;

  double squares_per_meter_, levels_per_meter_;
  std::map<Square, Sum> sums_;
};

/// The planes of all patches; read in batches, in parallel. `path` is that of their drive, or null.
PlaneHeights CollectPlanes(const PatchSource& patches, const DrivenPath* path,
                           const HeightFieldOptions& options);

}  // namespace parkade

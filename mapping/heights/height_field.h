#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "mapping/ground/patch_index.h"

namespace parkade {

/// The height of the ground at one place, as something measured it.
struct HeightObservation {
  Eigen::Vector3d point_in_site;  ///< [m]
  double weight = 1;              ///< inverse variance of z [1/m^2]
  double sigma = 0;  ///< [m] how well the height is known there, where observations share what they
                     ///< know; 0: by weight

  bool is_swept = false;  ///< views of the very place agreed on it

  double Sigma() const { return sigma > 0 ? sigma : 1 / std::sqrt(weight); }
};

/// What views of one patch agreed on.
struct MeasuredHeight {
  double height = 0;  ///< [m] mean
  double weight = 0;  ///< [1/m^2] of all of them; 0: none agreed
};

struct HeightFieldOptions {
  double spacing = 0.4;  ///< [m] between nodes; bumps shorter than two of them are not kept
  double curvature_sigma = 0.02;  ///< [1/m] of the road; smaller smooths more
  double level_separation =
      1.5;                 ///< [m] surfaces further apart in height are decks above each other
  bool has_steps = false;  ///< the plate gives way where observations bend it too much
  void Validate() const;   ///< throws Error{kUsage}
};

/// Heights of the ground on a sparse grid of nodes, bilinear between them, several decks allowed
/// above the same place. A square between four nodes of one deck is a patch; patches exist where
/// something was observed, and one ring around.
///
/// Heights minimize  sum_i w_i (z_i - h(x_i, y_i))^2  +  sum (second differences of h /
/// (curvature_sigma s^2))^2, a thin plate bent by its observations: where nothing but a far guess
/// is known it continues what is known nearby. Observations far from the result are weighed down
/// (Geman-McClure) in further rounds. D. Terzopoulos, "Multilevel computational processes for
/// visual surface reconstruction", CVGIP 1983.
class HeightField {
 public:
  static constexpr int kNone = -1;

  /// Observations may come in any order; the result does not depend on it but for rounding. Sparse
  /// Cholesky: about 1 s for 40 000 nodes. \param before  a field of much the same observations, by
  /// which they are weighed at first: that saves a round
  HeightField(std::vector<HeightObservation> observations, const HeightFieldOptions& options,
              const HeightField* before = nullptr);

  /// The patch at (x, y) whose height is nearest to z, less than a level separation away; or kNone.
  int FindPatch(const Eigen::Vector3d& point_in_site) const;

  /// Also; `height` [m] is that of the patch there, untouched where there is none.
  int FindPatch(const Eigen::Vector3d& point_in_site, double& height) const;

  /// [m] of the bilinear surface of a patch at (x, y), which may lie a little outside of it.
  double HeightAt(int patch, const Eigen::Vector2d& point_in_site) const;

  /// Calls `visit(patch, low, high)` with the heights [m] between which each patch that reaches
  /// into a box lies.
  template <typename Visitor>
  void VisitPatches(const Eigen::AlignedBox2d& box, const Visitor& visit) const {
    if (box.isEmpty()) return;
    const auto index = [&](double coordinate) {
      return static_cast<int>(std::floor(SquaresOf(coordinate)));
    };
    for (int y = index(box.min().y()); y <= index(box.max().y()); ++y)
      for (int x = index(box.min().x()); x <= index(box.max().x()); ++x)
        for (int patch = patches_at_.First(x, y); patch != kNone; patch = patches_at_.Next(patch)) {
          const auto& heights = corners_[static_cast<size_t>(patch)];
          const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
          visit(patch, static_cast<double>(*low), static_cast<double>(*high));
        }
  }

  /// [m] one sigma of the height: of the best observation in the patch or next to it.
  double SigmaOf(int patch) const { return patches_[static_cast<size_t>(patch)].sigma; }
  void SetSigma(int patch, double sigma) { patches_[static_cast<size_t>(patch)].sigma = sigma; }

  /// That of an observation: less, the further it is from the surface; where there is none, its
  /// own.
  double WeightOf(const HeightObservation& observation) const;

  const MeasuredHeight& MeasuredIn(int patch) const {
    return patches_[static_cast<size_t>(patch)].measured;
  }

  /// Grid index of the patch's lower corner, which is at index * spacing.
  Eigen::Vector2i IndexOf(int patch) const {
    return {patches_[static_cast<size_t>(patch)].x, patches_[static_cast<size_t>(patch)].y};
  }

  int num_patches() const { return static_cast<int>(patches_.size()); }
  int num_nodes() const { return static_cast<int>(heights_.size()); }
  double spacing() const { return options_.spacing; }

 private:
  struct Patch {
    int x = 0, y = 0;
    std::array<int, 4> nodes{};  ///< at (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)
    double guess = 0;            ///< [m] first height
    double sigma = 0;            ///< [m]
    MeasuredHeight measured = {};
  };
  class NormalEquations;
  friend class PatchFinder;
  double SquaresOf(double coordinate) const { return coordinate * squares_per_meter_; }
  void MakePatches(const std::vector<HeightObservation>& observations);
  void AddRing();
  void NumberByPlace();
  void MakeNodes();
  bool HasPatchNear(int x, int y, double height) const;
  void AddPatch(const Patch& patch);
  void KeepHeights();
  void KeepMeasured(const std::vector<HeightObservation>& observations);
  void Solve(const std::vector<HeightObservation>& observations, const HeightField* before);
  void AddThinPlate(bool breaks, NormalEquations& equations) const;
  void AddObservations(const std::vector<HeightObservation>& observations,
                       const HeightField* weighed_by, NormalEquations& equations);

  HeightFieldOptions options_;
  double squares_per_meter_;
  std::vector<Patch> patches_;
  PatchIndex patches_at_;
  std::vector<double> heights_;  ///< [m] of the nodes
  std::vector<std::array<float, 4>>
      corners_;  ///< [m] of the patches' nodes: what is looked up is packed densely
};

/// HeightField::FindPatch for places of which most lie in the same square as the one before: those
/// cost no look into the field. Borrows the field; for one thread.
class PatchFinder {
 public:
  explicit PatchFinder(const HeightField& field) : field_(&field) {}

  int Find(const Eigen::Vector3d& point_in_site, double& height);

 private:
  const HeightField* field_;
  int column_ = std::numeric_limits<int>::min(), row_ = 0;  // of the last square
  int patch_ = HeightField::kNone;                          // the only one there, if any
  std::array<float, 4> corners_{};                          // [m] of it
};

}  // namespace parkade

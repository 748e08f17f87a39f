#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/heights/sweep_agreement.h"

namespace parkade {

/// Where an observation meets the surface, and how that moves when the surface rises.
struct Meeting {
  Eigen::Vector2f point;  ///< [m] from the corner of the square that is swept
  Eigen::Vector2f shift;  ///< [m] per meter of height
  float gray = 0;         ///< less what is usual around it
  float weight = 0;
};

/// The square that is swept, and the heights.
struct SweepShape {
  int num_windows = 12;  ///< along each side
  int cells_per_window = 12;
  float cell_size = 0.1F;      ///< [m]
  std::vector<float> offsets;  ///< [m] of the surface
};

/// Moves samples along their rays to each height and sums up how well they agree there.
/// Observations of many views follow each other in any order. \return one per window (row by row)
/// and height: [window * offsets.size() + height]. O(observations * heights), heights in parallel.
class TileSweep {
 public:
  explicit TileSweep(SweepShape shape);

  void Add(const Meeting& observation) {
    x_.push_back(observation.point.x() * per_cell_ + 1),
        y_.push_back(observation.point.y() * per_cell_ + 1);
    dx_.push_back(observation.shift.x() * per_cell_),
        dy_.push_back(observation.shift.y() * per_cell_);
    const float weighted = observation.weight * observation.gray;
    sums_.emplace_back(observation.weight, weighted, weighted * observation.gray, 1.0F);
  }
  std::size_t num_observations() const { return x_.size(); }

  std::vector<Agreement> Sweep() const { return SweepTwice(nullptr); }

  /// Also; `coarse` gets the agreements of cells twice as long and wide, which far views, whose
  /// samples lie apart, need.
  std::vector<Agreement> SweepTwice(std::vector<Agreement>* coarse) const;

  /// By how much the shifts of a window's observations differ, rms [m per meter of height]:
  /// observations from one side say nothing of heights. One per window.
  std::vector<float> Parallaxes() const;

 private:
  /// What is known of a cell or a sample: weight, gray, its square (both weighted), number.
  using Sums = Eigen::Array4f;

  std::vector<Sums> AddUp(float offset) const;
  void AgreementsInto(std::size_t height, const std::vector<Sums>& cells, int cells_in_one,
                      std::vector<Agreement>& agreements) const;

  SweepShape shape_;
  float per_cell_ = 0;          ///< [1/m]
  int across_ = 0;              ///< cells, with a rim of one that gathers what lies outside
  std::vector<float> x_, y_;    ///< [cells]
  std::vector<float> dx_, dy_;  ///< [cells] per meter of height
  std::vector<Sums> sums_;
};

}  // namespace parkade

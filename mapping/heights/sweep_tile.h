#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
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

/// Moves samples along their rays to each height and sums up how well views agree there: means of a
/// cell, one per view, are compared with each other. Samples of one view are not: an edge along the
/// path, which looks alike at any height, would favor those at which it lies between cells.
/// \return one per window (row by row) and height: [window * offsets.size() + height].
/// O(observations * heights), heights in parallel.
class TileSweep {
 public:
  explicit TileSweep(SweepShape shape);

  /// What is added from here on is of another view.
  void BeginView() { views_.push_back(x_.size()); }

  /// The weight must be > 0.
  void Add(const Meeting& observation) {
    x_.push_back(observation.point.x() * per_cell_),
        y_.push_back(observation.point.y() * per_cell_);
    dx_.push_back(observation.shift.x() * per_cell_),
        dy_.push_back(observation.shift.y() * per_cell_);
    samples_.push_back({observation.weight, observation.weight * observation.gray});
  }
  std::size_t num_observations() const { return x_.size(); }

  std::vector<Agreement> Sweep() const { return SweepTwice(nullptr); }

  /// Also: `coarse` gets the agreements of cells twice as long and wide, which far views, whose
  /// samples lie apart, need.
  std::vector<Agreement> SweepTwice(std::vector<Agreement>* coarse) const;

  /// By how much the shifts of a window's observations differ, rms [m per meter of height]:
  /// observations from one side say nothing of heights. One per window.
  std::vector<float> Parallaxes() const;

 private:
  /// Sums of weights and of weighted grays.
  struct Sample {
    float weight = 0, gray = 0;
  };
  /// What views say about a cell.
  struct Cell {
    Sample all;
    float square = 0;  ///< of the views' means, weighted
    int num_views = 0;

    void Add(const Sample& of_view);
  };
  /// Cells row by row, with a rim of one that gathers what lies outside.
  class Grid {
   public:
    explicit Grid(int across);

    /// Adds what one view says, until EndView(). Weights must be > 0.
    void Add(std::span<const std::int32_t> cells, const Sample* samples);
    void EndView();
    /// Also: `coarse` gets the view's sums, of cell `i` in its `coarse_of[i]`.
    void EndView(std::span<const std::int32_t> coarse_of, Grid& coarse);

    int across() const { return across_; }
    const Cell& At(int column, int row) const {
      return cells_[static_cast<std::size_t>(row * across_ + column)];
    }

   private:
    int across_ = 0;
    std::vector<Cell> cells_;
    // What the view at hand says lies apart and close together: it is touched most often.
    std::vector<Sample> of_view_;
    std::vector<std::int32_t> seen_;
    std::size_t num_seen_ = 0;
    std::vector<Sample> sums_;  // of the cells that are seen, for the coarse grid
  };

  /// Along each side, `cells_in_one` of which, along each side, make one; with the rim.
  int NumCells(int cells_in_one) const {
    return shape_.num_windows * shape_.cells_per_window / cells_in_one + 2;
  }
  void AddUp(float offset, Grid& fine, Grid* coarse) const;
  void AgreementsOf(const Grid& grid, int cells_in_one, std::size_t height,
                    std::vector<Agreement>& agreements) const;

  SweepShape shape_;
  float per_cell_ = 0;          ///< [1/m]
  std::vector<float> x_, y_;    ///< [cells]
  std::vector<float> dx_, dy_;  ///< [cells] per meter of height
  std::vector<Sample> samples_;
  std::vector<std::size_t> views_;       ///< where each begins
  std::vector<std::int32_t> coarse_of_;  ///< of each cell of a Grid, that of the coarse one
};

}  // namespace parkade

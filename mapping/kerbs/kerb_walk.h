#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "mapping/ground/cell_finder.h"
#include "mapping/kerbs/kerb_ends.h"

namespace parkade {

/// A place that was seen to have no kerb, though the outline of the ground goes along there.
struct NoKerb {
  Eigen::Vector3d foot;   ///< [m] in site
  Eigen::Vector2d along;  ///< unit
};

/// Where kerbs are already. They are few; places are looked for in squares of 1 m.
class TakenPlaces {
 public:
  void Add(const std::vector<Eigen::Vector3d>& line, std::size_t kerb);
  /// Whether another kerb than `kerb` lies within half a meter.
  bool IsTaken(const Eigen::Vector3d& place, std::size_t kerb) const;

 private:
  std::map<std::pair<int, int>, std::vector<std::pair<Eigen::Vector3d, std::size_t>>> squares_;
};

/// Where a walk from an end of a kerb leads to.
struct KerbWalk {
  std::vector<Eigen::Vector3d> points = {};  ///< [m] in site: of the kerb, from its end on
  double hidden_length = 0;                  ///< [m] between them where no stone was seen
  std::optional<std::size_t> met = {};       ///< the kerb that it leads to ...
  double hidden_before_met = 0;  ///< [m] ... and what is hidden from the last point to that
};

/// Follows the lines of kerbs beyond their ends. Cells and places are borrowed.
class KerbWalker {
 public:
  KerbWalker(const CellFinder& cells, std::span<const NoKerb> no_kerbs, const TakenPlaces& taken);

  /// Goes on while cells beside the line look like a kerb, or like something raised beside a
  /// vehicle, which moves the line a little, or while a vehicle hides it, no longer than
  /// `end.max_hidden`; and no further than open ground, another kerb, or a place without one.
  /// \param end  with a line \param kerb  whose end \param left  1 where the ground lies on the
  /// left of the way, else -1 \param others  by kerb, its end that may be met; null: not that one
  KerbWalk Follow(const KerbEnd& end, std::size_t kerb, double left,
                  std::span<const KerbEnd* const> others) const;

 private:
  std::size_t CountDenials(const Eigen::Vector3d& foot, const Eigen::Vector2d& direction) const;

  const CellFinder* cells_;
  std::map<std::pair<int, int>, std::vector<NoKerb>> no_kerbs_;  ///< in squares of 1 m
  const TakenPlaces* taken_;
};

}  // namespace parkade

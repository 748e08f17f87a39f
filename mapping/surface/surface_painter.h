#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/surface_map.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/latest_drives.h"
#include "mapping/ground/patch_source.h"
#include "mapping/heights/height_field.h"
#include "mapping/surface/cell_evidence.h"
#include "mapping/surface/observation_summary.h"

namespace parkade {

/// Colors and free-space evidence gathered on the patches of a height field, one drive after the
/// other.
class SurfacePainter {
 public:
  /// The field is borrowed. `cells_per_side` cells on each side of a patch.
  /// \param window  squares of the field that are painted, the last one being the one before max();
  /// nothing: all.
  ///                What is painted of them does not depend on the window.
  SurfacePainter(const HeightField& field, int cells_per_side,
                 const std::optional<Eigen::AlignedBox2i>& window = {});

  /// Whether samples of a patch that lie in a part of its extent may lie in the window, once they
  /// have moved along their rays. `path` may be null.
  bool IsInReach(const PatchView& view, const Eigen::AlignedBox2d& part,
                 const DrivenPath* path) const;

  /// Samples of some of a drive's patches, moved along their rays onto the surface. In parallel,
  /// summed in order. `path` is that of the drive, or null; `latest` was made of the same patches.
  ///
  /// A cell has the color that the latest of the drives that saw it well gives it.
  ///
  /// Behind the foot of an obstacle nothing is known, so that a parked car hardly counts against
  /// its slot. But ground that an earlier drive saw, and that this drive does not see from anywhere
  /// although it looked from where that one had seen it, is covered now.
  void PaintDrive(const PatchSource& patches, std::span<const size_t> indices,
                  const DrivenPath* path, const LatestDrives* latest = nullptr);

  /// Where a car has been there is room for it, and still is where its drive has a say. One of
  /// unknown size is taken for a very small one.
  void MarkDriven(const DrivenPath& path, const LatestDrives* latest = nullptr);

  /// A cell of the result with what has not yet been decided about it.
  struct PaintedCell {
    SurfaceCell cell;
    float shown_log_odds = 0;  ///< of the latest drive that told of it
    bool is_seen = false;      ///< has a color
    bool is_driven = false;
    float raised = 0;     ///< [m] above where the road that cars drove on would go on to
    float measured = 0;   ///< [m] the same of what views of the place agreed on; 0 without
    float certainty = 0;  ///< of that, 0..1
    ObservationSummary observations;
  };

  /// Every cell of every patch in which anything was seen or driven, the unseen ones too; sorted as
  /// SurfaceMap.
  std::vector<PaintedCell> Cells() const;

 private:
  /// The range of the cells of one square that a sample stands for.
  struct Hit {
    std::uint32_t first = 0;              ///< evidence of the lowest of them
    std::uint16_t columns = 0, rows = 0;  ///< of cells
    CellObservation observation;
  };

  /// Squares are divided among threads.
  static constexpr std::size_t kShares = 4;
  using SharedHits = std::array<std::vector<Hit>, kShares>;

  void Paint(const PatchSource& patches, std::span<const size_t> indices, const DrivenPath* path,
             const LatestDrives* latest);
  void EndDrive();
  void AddHit(const GroundSample& sample, int patch, const Eigen::Vector3d& point, double log_odds,
              ViewSet view, SharedHits& hits) const;
  void AddTo(int patch, const Eigen::Vector2i& begin, const Eigen::Vector2i& end, Hit hit,
             SharedHits& hits) const;
  SharedHits FindHits(const PatchView& view, const GroundPatch& patch, const DrivenPath* path,
                      const LatestDrives::Share* share) const;
  static Eigen::AlignedBox2d ReachOf(const Eigen::AlignedBox2d& extent, const Eigen::Vector3d* eye);
  bool IsInReach(const Eigen::Vector3d* eye, const Eigen::Vector3d& point) const;
  bool IsPainted(int patch) const {
    return slots_[static_cast<size_t>(patch)] != HeightField::kNone;
  }
  /// The square of the height field in which a cell lies.
  Eigen::Vector2i SquareAt(const Eigen::Vector2i& cell) const;
  std::uint32_t FirstEvidenceOf(int patch) const;
  std::uint32_t EvidenceAt(int patch, const Eigen::Vector2i& cell) const;
  Eigen::Vector2i CellAt(const Eigen::Vector2d& point_in_site) const;

  const HeightField* field_;
  int cells_per_side_;
  double cell_size_;
  std::vector<int> slots_;    ///< by patch: where its evidence is, or none
  std::vector<int> painted_;  ///< patches that have a slot, in order
  Eigen::AlignedBox2d
      reach_;  ///< [m] of the window, and of samples that stand for more than a cell
  std::vector<CellEvidence> evidence_;  ///< slots x cells_per_side^2
  bool has_earlier_ = false;            ///< a drive before the one that is painted
};

}  // namespace parkade

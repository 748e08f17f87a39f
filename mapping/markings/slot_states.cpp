#include "mapping/markings/slot_states.h"

#include <array>
#include <cmath>
#include <optional>

#include "core/math/fast_floor.h"
#include "core/parallel.h"
#include "mapping/ground/isometry_of.h"
#include "mapping/ground/nearest_views.h"
#include "mapping/ground/patch_index.h"

namespace parkade {
namespace {

constexpr double kSideMargin =
    0.25;  // [m] beside the lines that does not count: who parks badly, and who walks past
constexpr double kEndMargin = 0.4;   // [m] the same at the ends
constexpr double kFreeShare = 0.55;  // of what is left that must be seen as ground in a free slot
constexpr double kOccupiedShare = 0.03;  // the least share of something else in an occupied one
constexpr double kSquare = 1.0;          // [m] of the squares in which slots are sorted
constexpr double kReach = 0.5;  // [m] that a ray may move between its own plane and the slot's
constexpr double kMaxHeightStep = 1.2;  // [m] between those
constexpr int kColumns = 8, kRows = 16;
constexpr float kKnown = 0.15F;     // of evidence in a cell
constexpr int kViewsOfSlot = 40;    // by a drive
constexpr std::size_t kBatch = 64;  // patches whose hits are held at once

using Cells = std::array<float, kColumns * kRows>;

/// Slots by squares of ground.
class SlotSquares {
 public:
  explicit SlotSquares(const std::vector<ParkingSlot>& slots) {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      Eigen::Array2d low = slots[i].corners[0].head<2>().array(), high = low;
      for (const Eigen::Vector3d& corner : slots[i].corners) {
        low = low.min(corner.head<2>().array());
        high = high.max(corner.head<2>().array());
      }
      const auto first = ((low - kReach) / kSquare).floor().cast<int>().eval();
      const auto last = ((high + kReach) / kSquare).floor().cast<int>().eval();
      for (int x = first.x(); x <= last.x(); ++x)
        for (int y = first.y(); y <= last.y(); ++y) {
          squares_.Add(x, y);
          slots_.push_back(i);
        }
    }
  }

  /// Calls `visit(slot)` for those that may lie at a point.
  template <typename Visitor>
  void VisitAt(const Eigen::Vector3d& point, const Visitor& visit) const {
    for (int entry = squares_.First(FastFloor(point.x() / kSquare), FastFloor(point.y() / kSquare));
         entry != PatchIndex::kNone; entry = squares_.Next(entry))
      visit(slots_[static_cast<std::size_t>(entry)]);
  }

 private:
  PatchIndex squares_;
  std::vector<std::size_t> slots_;  // by the entries' numbers
};

/// The part of a slot that counts, as an affine grid.
struct SlotGrid {
  Eigen::Vector3d origin;
  Eigen::Vector2d across, inward;  ///< unit vectors
  double columns_per_meter = 0, rows_per_meter = 0;

  explicit SlotGrid(const ParkingSlot& slot) {
    origin = slot.corners[0];
    across = (slot.corners[1] - slot.corners[0]).head<2>().normalized();
    inward = Eigen::Vector2d(-across.y(), across.x());
    columns_per_meter = kColumns / (slot.Entrance() - 2 * kSideMargin);
    rows_per_meter = kRows / (slot.Depth() - 2 * kEndMargin);
  }

  /// Index of the cell at a point on the slot's plane, or nothing.
  std::optional<std::size_t> CellAt(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d offset = point - origin.head<2>();
    const double column = (offset.dot(across) - kSideMargin) * columns_per_meter;
    const double row = (offset.dot(inward) - kEndMargin) * rows_per_meter;
    if (!(column >= 0 && column < kColumns && row >= 0 && row < kRows)) return {};
    return static_cast<std::size_t>(static_cast<int>(row) * kColumns + static_cast<int>(column));
  }
};

/// Where the ray from the eye through a point meets the height of a slot.
Eigen::Vector3d MeetHeight(const std::optional<Eigen::Vector3d>& eye, const Eigen::Vector3d& point,
                           double height) {
  if (!eye || eye->z() - point.z() < 0.1 || eye->z() - height < 0.1) return point;
  return *eye + (eye->z() - height) / (eye->z() - point.z()) * (point - *eye);
}

struct Hit {
  std::size_t slot = 0, cell = 0;
  float evidence = 0;  ///< positive: ground
};

/// \param box  [m] in site, around the slots that are asked for
std::vector<Hit> FindHits(const PosedGroundPatch& patch, std::span<const DrivenPath> paths,
                          const SlotSquares& squares, const std::vector<SlotGrid>& grids,
                          const Eigen::AlignedBox2d& box) {
  std::vector<Hit> hits;
  const DrivenPath* path = FindPath(paths, patch.patch.drive);
  const auto camera = static_cast<std::size_t>(patch.patch.camera);
  std::optional<Eigen::Vector3d> eye;
  if (path != nullptr && camera < path->cameras_in_body.size())
    eye = patch.site_from_body * path->cameras_in_body[camera];
  const Eigen::Isometry3d site_from_body = IsometryOf(patch.site_from_body);
  for (const GroundSample& sample : patch.patch.samples) {
    if (sample.confidence <= 0) continue;
    const Eigen::Vector3d point = site_from_body * sample.point_in_body.cast<double>();
    if (!box.contains(point.head<2>())) continue;
    squares.VisitAt(point, [&](std::size_t slot) {
      const double height = grids[slot].origin.z();
      if (std::abs(point.z() - height) > kMaxHeightStep) return;
      const std::optional<std::size_t> cell =
          grids[slot].CellAt(MeetHeight(eye, point, height).head<2>());
      if (cell) hits.push_back({slot, *cell, (sample.is_free ? 1.0F : -1.0F) * sample.confidence});
    });
  }
  return hits;
}

/// [m] in site: the plane on which a car stands, at a place.
double HeightOfPlane(const Rigid3& site_from_ground, const Eigen::Vector2d& place) {
  const Eigen::Vector3d normal = site_from_ground.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d away = place - site_from_ground.translation.head<2>();
  return site_from_ground.translation.z() - normal.head<2>().dot(away) / normal.z();
}

/// What is known of a slot and a drive.
std::optional<SlotState> KnownOf(std::span<const KnownStates> known, std::size_t slot,
                                 std::size_t drive) {
  return slot < known.size() && drive < known[slot].size() ? known[slot][drive] : std::nullopt;
}

/// [m] in site, by drive: where the slots lie of which it is not known what the drive saw.
std::vector<Eigen::AlignedBox2d> BoxesToSee(const std::vector<ParkingSlot>& slots,
                                            std::size_t num_drives,
                                            std::span<const KnownStates> known) {
  std::vector<Eigen::AlignedBox2d> boxes(num_drives);
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(kReach);
  for (std::size_t i = 0; i < slots.size(); ++i)
    for (std::size_t drive = 0; drive < num_drives; ++drive) {
      if (KnownOf(known, i, drive)) continue;
      for (const Eigen::Vector3d& corner : slots[i].corners)
        boxes[drive].extend(corner.head<2>() - reach).extend(corner.head<2>() + reach);
    }
  return boxes;
}

/// Views that tell what is not known of the slots, some of every drive for each: the nearest ones.
std::vector<std::size_t> ChooseViews(std::span<const PatchView> views,
                                     std::span<const DrivenPath> paths, std::size_t num_drives,
                                     const std::vector<ParkingSlot>& slots,
                                     std::span<const KnownStates> known) {
  std::vector<Eigen::AlignedBox2d> boxes(slots.size());
  for (std::size_t i = 0; i < slots.size(); ++i)
    for (const Eigen::Vector3d& corner : slots[i].corners) boxes[i].extend(corner.head<2>().eval());
  std::vector<TargetView> target_views;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto drive = static_cast<std::size_t>(views[i].drive);
    if (drive >= num_drives) continue;
    const DrivenPath* path = FindPath(paths, views[i].drive);
    const Rigid3 site_from_ground =
        path ? views[i].site_from_body * path->body_from_ground : views[i].site_from_body;
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
      if (KnownOf(known, slot, drive)) continue;
      if (views[i].extent.exteriorDistance(boxes[slot]) > kReach) continue;
      const Eigen::Vector2d middle = boxes[slot].center();
      const double height = HeightOfPlane(site_from_ground, middle);
      if (std::abs(height - slots[slot].corners[0].z()) > kMaxHeightStep) continue;
      const double distance = (views[i].site_from_body.translation.head<2>() - middle).norm();
      target_views.push_back({static_cast<float>(distance), static_cast<std::uint32_t>(i),
                              static_cast<std::uint32_t>(drive * slots.size() + slot)});
    }
  }
  const std::vector<bool> is_chosen =
      ChooseNearest(std::move(target_views), views.size(),
                    std::vector<int>(num_drives * slots.size(), kViewsOfSlot));
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (is_chosen[i]) chosen.push_back(i);
  return chosen;
}

SlotState StateOf(const Cells& cells) {
  double num_free = 0, num_other = 0;
  for (const float evidence : cells) {
    num_free += evidence > kKnown;
    num_other += evidence < -kKnown;
  }
  const double count = kColumns * kRows;
  if (num_free >= kFreeShare * count && num_other < 0.25 * num_free) return SlotState::kFree;
  if (num_other >= kOccupiedShare * count && num_free < kFreeShare * count)
    return SlotState::kOccupied;
  return SlotState::kUnseen;
}

}  // namespace

void SeeSlots(const PatchSource& patches, std::span<const DrivenPath> paths, std::size_t num_drives,
              std::vector<ParkingSlot>& slots, std::span<const KnownStates> known) {
  const SlotSquares squares(slots);
  std::vector<SlotGrid> grids;
  grids.reserve(slots.size());
  for (const ParkingSlot& slot : slots) grids.emplace_back(slot);
  std::vector<std::vector<Cells>> cells(num_drives, std::vector<Cells>(slots.size(), Cells{}));
  const std::vector<Eigen::AlignedBox2d> boxes = BoxesToSee(slots, num_drives, known);
  const std::vector<std::size_t> chosen =
      ChooseViews(patches.views(), paths, num_drives, slots, known);
  for (std::size_t begin = 0; begin < chosen.size(); begin += kBatch) {
    const std::span batch =
        std::span(chosen).subspan(begin, std::min(kBatch, chosen.size() - begin));
    const auto hits = ParallelMap(batch.size(), [&](std::size_t i) {
      const auto drive = static_cast<std::size_t>(patches.views()[batch[i]].drive);
      return FindHits(patches.Read(batch[i]), paths, squares, grids, boxes[drive]);
    });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const auto drive = static_cast<std::size_t>(patches.views()[batch[i]].drive);
      for (const Hit& hit : hits[i]) cells[drive][hit.slot][hit.cell] += hit.evidence;
    }
  }
  for (std::size_t i = 0; i < slots.size(); ++i) {
    slots[i].states.clear();
    for (std::size_t drive = 0; drive < num_drives; ++drive)
      slots[i].states.push_back(KnownOf(known, i, drive).value_or(StateOf(cells[drive][i])));
  }
}

}  // namespace parkade

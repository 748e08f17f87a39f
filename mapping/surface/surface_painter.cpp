#include "mapping/surface/surface_painter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "core/math/fast_floor.h"
#include "core/parallel.h"
#include "mapping/ground/isometry_of.h"
#include "mapping/ground/sort_cells.h"
#include "mapping/heights/ground_horizon.h"
#include "mapping/heights/intersect_ray.h"

namespace parkade {
namespace {

constexpr double kFreeLogOdds =
    0.8;  // of one observation of free ground near the car; less with distance
constexpr double kOccupiedLogOdds =
    0.8;  // of one observation of something else; more keeps obstacles, and their halo, out
constexpr double kNearVariance = 1e-4;  // [m^2] of the height of a sample right at the car
constexpr double kNearEnough =
    0.75;  // observations from here on are equally sharp: the first come before the own shadow
constexpr double kKnownShift = 0.3;    // [m] along the ray at which an outline counts half
constexpr double kLeastTrust = 0.05;   // what is seen of a poorly known height still counts
constexpr double kMinEyeHeight = 0.2;  // [m] above the ground
constexpr double kTrustedView = 0.5;   // trust from which on it is known what was looked at
constexpr double kDoubtfulLogOdds =
    -1e-6;  // of an observation that cannot tell: with nothing else, not drivable
constexpr double kMaxStretch = 1.5;      // of rays: IntersectRay goes no further
constexpr double kMaxFootprint = 1.0;    // [m] that samples stand for reach less far from them
constexpr size_t kPatchesPerBatch = 64;  // hits of so many patches are held at once
constexpr WheelbaseFootprint kSmallestCar{1.6, 1.1};  // where the rig does not know its size

/// 1 right at the car, falling with distance: whose color counts. Much slower than the variance of
/// a height grows.
double NearnessOf(const GroundSample& sample) {
  return std::min(1.0, std::sqrt(std::sqrt(kNearVariance * static_cast<double>(sample.weight))));
}

/// Where a motion takes points of the plane z = 0, seen along z.
Eigen::Affine2d InPlane(const Rigid3& motion) {
  Eigen::Affine2d in_plane;
  in_plane.linear() = motion.rotation.toRotationMatrix().topLeftCorner<2, 2>();
  in_plane.translation() = motion.translation.head<2>();
  return in_plane;
}

/// The part of a line across the car that a motion takes into a box [m in y]; none of it where the
/// end comes first.
struct Stretch {
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();

  Stretch(const Eigen::Affine2d& motion, double x, const Eigen::AlignedBox2d& box) {
    const Eigen::Vector2d start = motion * Eigen::Vector2d(x, 0), step = motion.linear().col(1);
    for (int i = 0; i < 2; ++i) {
      const double low = box.min()[i] - start[i], high = box.max()[i] - start[i];
      if (step[i] == 0) {
        if (low > 0 || high < 0) end = -std::numeric_limits<double>::infinity();
        continue;
      }
      const double at_low = low / step[i], at_high = high / step[i];
      begin = std::max(begin, std::min(at_low, at_high));
      end = std::min(end, std::max(at_low, at_high));
    }
  }
  bool Contains(double y) const { return y >= begin && y <= end; }
};

/// [m] in site: the camera of a view. Nothing where it is not known.
std::optional<Eigen::Vector3d> EyeOf(const PatchView& view, const DrivenPath* path) {
  const auto camera = static_cast<size_t>(view.camera);
  if (path == nullptr || camera >= path->cameras_in_body.size()) return std::nullopt;
  return view.site_from_body * path->cameras_in_body[camera];
}

}  // namespace

SurfacePainter::SurfacePainter(const HeightField& field, int cells_per_side,
                               const std::optional<Eigen::AlignedBox2i>& window)
    : field_(&field),
      cells_per_side_(cells_per_side),
      cell_size_(field.spacing() / cells_per_side),
      slots_(static_cast<size_t>(field.num_patches()), HeightField::kNone) {
  int num_slots = 0;
  for (int patch = 0; patch < field.num_patches(); ++patch) {
    const Eigen::Array2i at = field.IndexOf(patch).array();
    if (window && ((at < window->min().array()).any() || (at >= window->max().array()).any()))
      continue;
    slots_[static_cast<size_t>(patch)] = num_slots++;
    painted_.push_back(patch);
    const Eigen::Array2d low = at.cast<double>() * field.spacing();
    reach_.extend((low - kMaxFootprint).matrix())
        .extend((low + field.spacing() + kMaxFootprint).matrix());
  }
  evidence_.resize(static_cast<size_t>(num_slots) *
                   static_cast<size_t>(cells_per_side * cells_per_side));
}

/// Where samples of an extent may lie once they have moved along their rays. `eye` may be null.
Eigen::AlignedBox2d SurfacePainter::ReachOf(const Eigen::AlignedBox2d& extent,
                                            const Eigen::Vector3d* eye) {
  Eigen::AlignedBox2d reach = extent;
  if (eye == nullptr || reach.isEmpty()) return reach;
  const Eigen::Vector2d from = eye->head<2>();
  return reach.extend(from)
      .extend((from + kMaxStretch * (extent.min() - from)).eval())
      .extend((from + kMaxStretch * (extent.max() - from)).eval());
}

bool SurfacePainter::IsInReach(const PatchView& view, const Eigen::AlignedBox2d& part,
                               const DrivenPath* path) const {
  const std::optional<Eigen::Vector3d> eye = EyeOf(view, path);
  const Eigen::AlignedBox2d reach = ReachOf(view.extent.intersection(part), eye ? &*eye : nullptr);
  return !reach.isEmpty() && !reach_.isEmpty() && reach_.intersects(reach);
}

/// Whether the ray through a point may meet the surface in reach of the window.
bool SurfacePainter::IsInReach(const Eigen::Vector3d* eye, const Eigen::Vector3d& point) const {
  if (reach_.contains(point.head<2>().eval())) return true;
  Eigen::AlignedBox2d ray(point.head<2>());
  if (eye != nullptr)
    ray.extend(eye->head<2>()).extend((*eye + kMaxStretch * (point - *eye)).head<2>());
  return reach_.intersects(ray);
}

Eigen::Vector2i SurfacePainter::CellAt(const Eigen::Vector2d& point_in_site) const {
  return (point_in_site / cell_size_).array().floor().matrix().cast<int>();
}

Eigen::Vector2i SurfacePainter::SquareAt(const Eigen::Vector2i& cell) const {
  return {FloorDivide(cell.x(), cells_per_side_), FloorDivide(cell.y(), cells_per_side_)};
}

std::uint32_t SurfacePainter::FirstEvidenceOf(int patch) const {
  return static_cast<std::uint32_t>(slots_[static_cast<size_t>(patch)] * cells_per_side_ *
                                    cells_per_side_);
}

std::uint32_t SurfacePainter::EvidenceAt(int patch, const Eigen::Vector2i& cell) const {
  const Eigen::Vector2i inside = cell - field_->IndexOf(patch) * cells_per_side_;
  const int x = std::clamp(inside.x(), 0, cells_per_side_ - 1),
            y = std::clamp(inside.y(), 0, cells_per_side_ - 1);
  return FirstEvidenceOf(patch) + static_cast<std::uint32_t>(y * cells_per_side_ + x);
}

/// A sample that stands for more than a cell counts for all of them.
void SurfacePainter::AddHit(const GroundSample& sample, int patch, const Eigen::Vector3d& point,
                            double log_odds, ViewSet view, SharedHits& hits) const {
  const double nearness = NearnessOf(sample);
  const auto rank =
      static_cast<std::uint8_t>(1 + std::lround(254 * std::min(nearness, kNearEnough)));
  // What lies far behind an outline is no observation of the ground: it only tells that there is
  // none.
  const Hit hit{.observation = {.color = {sample.blue, sample.green, sample.red,
                                          sample.IsBeyond() ? std::uint8_t{0} : rank},
                                .log_odds = static_cast<float>(log_odds),
                                .view = view,
                                .surface = sample.surface}};
  const double reach = std::max(0.0, 0.5 * (static_cast<double>(sample.footprint) - cell_size_));
  const Eigen::Vector2i low = CellAt(point.head<2>().array() - reach),
                        high = CellAt(point.head<2>().array() + reach);
  const Eigen::Vector2i home = field_->IndexOf(patch), origin = home * cells_per_side_;
  if ((low.array() >= origin.array()).all() &&
      (high.array() < origin.array() + cells_per_side_).all()) {
    AddTo(patch, low, high.array() + 1, hit, hits);
    return;
  }
  const Eigen::Vector2i first = SquareAt(low), last = SquareAt(high);
  for (int row = first.y(); row <= last.y(); ++row)
    for (int column = first.x(); column <= last.x(); ++column) {
      const Eigen::Vector2i square(column, row), corner = square * cells_per_side_;
      const Eigen::Vector2i begin = low.cwiseMax(corner),
                            end = (high.array() + 1).min(corner.array() + cells_per_side_);
      const Eigen::Vector2d middle = 0.5 * cell_size_ * (begin + end).cast<double>();
      const int owner =
          square == home ? patch : field_->FindPatch({middle.x(), middle.y(), point.z()});
      if (owner == HeightField::kNone) continue;
      AddTo(owner, begin, end, hit, hits);
    }
}

/// Counts a hit for the cells of a square from `begin` to before `end`, where it is painted.
void SurfacePainter::AddTo(int patch, const Eigen::Vector2i& begin, const Eigen::Vector2i& end,
                           Hit hit, SharedHits& hits) const {
  if (!IsPainted(patch)) return;
  hit.first = EvidenceAt(patch, begin);
  hit.columns = static_cast<std::uint16_t>(end.x() - begin.x());
  hit.rows = static_cast<std::uint16_t>(end.y() - begin.y());
  hits[static_cast<size_t>(slots_[static_cast<size_t>(patch)]) % kShares].push_back(hit);
}

SurfacePainter::SharedHits SurfacePainter::FindHits(const PatchView& view, const GroundPatch& patch,
                                                    const DrivenPath* path,
                                                    const LatestDrives::Share* share) const {
  SharedHits hits;
  for (std::vector<Hit>& of_share : hits) of_share.reserve(2 * patch.samples.size() / kShares);
  const std::optional<Eigen::Vector3d> seen_from = EyeOf(view, path);
  const bool has_eye = seen_from.has_value();
  const Eigen::Vector3d eye = seen_from.value_or(Eigen::Vector3d::Zero());
  const Eigen::AlignedBox2d reach = ReachOf(
      share ? view.extent.intersection(share->Extent()) : view.extent, has_eye ? &eye : nullptr);
  const bool is_all_in_reach = reach_.contains(reach);
  PatchFinder patches(*field_);
  const Eigen::Isometry3d site_from_body = IsometryOf(view.site_from_body);
  const std::optional<GroundHorizon> horizon =
      has_eye ? std::make_optional<GroundHorizon>(*field_, eye, reach) : std::nullopt;
  const bool tells_beyond = has_earlier_ && has_eye;
  for (const GroundSample& sample : patch.samples) {
    if (sample.IsBeyond() && !tells_beyond) continue;
    Eigen::Vector3d point = site_from_body * sample.point_in_body.cast<double>();
    if (!is_all_in_reach && !IsInReach(has_eye ? &eye : nullptr, point)) continue;
    if (share != nullptr && !share->Counts(point.head<2>())) continue;
    const int found = has_eye ? IntersectRay(patches, eye, point) : field_->FindPatch(point);
    if (found == HeightField::kNone) continue;
    if (horizon && horizon->MayHide(point) && IsHidden(*field_, eye, point)) continue;
    const double distance = has_eye ? (point - eye).head<2>().norm() : 0;
    const double depth = has_eye ? std::max(eye.z() - point.z(), kMinEyeHeight) : 1;
    // An error of the height moves what is seen along the ray.
    const double shift = distance / depth * field_->SigmaOf(found) / kKnownShift;
    const double trust = std::max(kLeastTrust, 1 / (1 + shift * shift));
    if (sample.IsDoubtful()) {
      AddHit(sample, found, point, kDoubtfulLogOdds, 0, hits);
      continue;
    }
    const ViewSet view_bit = has_eye && trust > kTrustedView ? ViewFrom(eye, point) : 0;
    if (sample.IsBeyond() && view_bit == 0) continue;
    AddHit(sample, found, point,
           (sample.is_free ? kFreeLogOdds : -kOccupiedLogOdds) *
               static_cast<double>(sample.confidence) * trust,
           view_bit, hits);
  }
  return hits;
}

void SurfacePainter::Paint(const PatchSource& patches, std::span<const size_t> indices,
                           const DrivenPath* path, const LatestDrives* latest) {
  for (size_t begin = 0; begin < indices.size(); begin += kPatchesPerBatch) {
    const std::span batch =
        indices.subspan(begin, std::min(kPatchesPerBatch, indices.size() - begin));
    const auto hits_of = ParallelMap(batch.size(), [&](size_t i) {
      return FindHits(patches.views()[batch[i]], patches.Read(batch[i]).patch, path,
                      latest ? &latest->ShareOf(batch[i]) : nullptr);
    });
    // Each thread has cells of its own, so that those of a cell come in order.
    ParallelFor(kShares, [&](size_t share) {
      for (const SharedHits& hits : hits_of)
        for (const Hit& hit : hits[share]) {
          for (size_t y = 0; y < hit.rows; ++y) {
            const auto row =
                std::span(evidence_).subspan(hit.first + y * static_cast<size_t>(cells_per_side_));
            for (CellEvidence& evidence : row.first(hit.columns)) evidence.Count(hit.observation);
          }
        }
    });
  }
}

void SurfacePainter::EndDrive() {
  for (CellEvidence& evidence : evidence_) evidence.EndDrive();
  has_earlier_ = true;
}

void SurfacePainter::PaintDrive(const PatchSource& patches, std::span<const size_t> indices,
                                const DrivenPath* path, const LatestDrives* latest) {
  Paint(patches, indices, path, latest);
  EndDrive();
}

void SurfacePainter::MarkDriven(const DrivenPath& path, const LatestDrives* latest) {
  const bool is_known = path.contact.wheelbase > 0 && path.contact.track > 0;
  const WheelbaseFootprint car = is_known ? path.contact : kSmallestCar;
  const double step = 2 * cell_size_, length = car.wheelbase + car.track + 1;
  // Every cell well inside of where the car stood last is marked already.
  const double rim = 2.5 * cell_size_, half_track = 0.5 * car.track;
  const Eigen::AlignedBox2d inside(Eigen::Vector2d(rim, rim - half_track),
                                   Eigen::Vector2d(car.wheelbase - rim, half_track - rim));
  const double apart = 0.7 * cell_size_;  // of places: no cell is missed
  std::optional<Rigid3> stood_from_site;
  std::optional<Eigen::Vector3d> last;
  PatchFinder patches(*field_);
  for (const TrajectoryState& state : path.site_from_body.states()) {
    if (last && (state.world_from_body.translation - *last).norm() < step) continue;
    last = state.world_from_body.translation;
    if (reach_.isEmpty() || reach_.exteriorDistance(last->head<2>().eval()) > length) continue;
    if (latest && !latest->CountsAsDriven(path.drive, *last)) {
      stood_from_site.reset();
      continue;
    }
    const Rigid3 site_from_ground = state.world_from_body * path.body_from_ground;
    const Eigen::Affine2d stood_from_ground = stood_from_site
                                                  ? InPlane(*stood_from_site * site_from_ground)
                                                  : Eigen::Affine2d::Identity();
    for (int i = 0; i * apart <= car.wheelbase; ++i) {
      const double x = i * apart;
      const Stretch marked(stood_from_ground, x, inside);
      for (int k = 0; k * apart <= 2 * half_track; ++k) {
        const double y = k * apart - half_track;
        if (stood_from_site && marked.Contains(y)) {
          k = std::max(k, static_cast<int>((marked.end + half_track) / apart));
          continue;
        }
        const Eigen::Vector3d point = site_from_ground * Eigen::Vector3d(x, y, 0);
        double height = 0;
        const int patch = patches.Find(point, height);
        if (patch == HeightField::kNone || !IsPainted(patch)) continue;
        CellEvidence& evidence = evidence_[EvidenceAt(patch, CellAt(point.head<2>()))];
        evidence.is_driven = true;
        evidence.log_odds = kLogOddsLimit;
      }
    }
    stood_from_site = site_from_ground.Inverse();
  }
}

std::vector<SurfacePainter::PaintedCell> SurfacePainter::Cells() const {
  const int cells_per_patch = cells_per_side_ * cells_per_side_;
  const auto cells_of = ParallelMap(painted_.size(), [&](size_t slot) {
    std::vector<PaintedCell> cells;
    const int patch = painted_[slot];
    const auto begin = evidence_.begin() + static_cast<std::ptrdiff_t>(slot) * cells_per_patch;
    if (std::none_of(begin, begin + cells_per_patch, std::mem_fn(&CellEvidence::IsKnown)))
      return cells;
    const Eigen::Vector2i corner = field_->IndexOf(patch) * cells_per_side_;
    for (int i = 0; i < cells_per_patch; ++i) {
      const CellEvidence& evidence = *(begin + i);
      PaintedCell& painted = cells.emplace_back();
      painted.cell.x = corner.x() + i % cells_per_side_;
      painted.cell.y = corner.y() + i / cells_per_side_;
      const Eigen::Vector2d center =
          cell_size_ * Eigen::Vector2d(painted.cell.x + 0.5, painted.cell.y + 0.5);
      painted.cell.height = static_cast<float>(field_->HeightAt(patch, center));
      painted.cell.height_sigma = static_cast<float>(field_->SigmaOf(patch));
      painted.cell.free_belief = 1 / (1 + std::exp(-evidence.log_odds));
      painted.cell.color = evidence.observations.Color();
      painted.cell.class_beliefs = evidence.ClassBeliefs();
      painted.shown_log_odds = evidence.shown.log_odds;
      painted.is_seen = !evidence.observations.empty();
      painted.is_driven = evidence.is_driven;
      painted.observations = evidence.Summary();
    }
    return cells;
  });
  std::vector<PaintedCell> all;
  for (const auto& cells : cells_of) all.insert(all.end(), cells.begin(), cells.end());
  SortCells(all);
  return all;
}

}  // namespace parkade

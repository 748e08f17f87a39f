#include "mapping/markings/find_speed_bumps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "mapping/ground/cell_finder.h"

namespace parkade {
namespace {

constexpr double kSameBump = 1.5;    // [m] between the crests of two passes
constexpr double kSameHeight = 1.0;  // [m] between samples of one height
constexpr double kBaseReach =
    1.5;  // [m] of ground before and behind that the height is measured from
constexpr double kFootShare =
    0.25;  // of the height that ends a bump: the ground around it is not straight
constexpr double kMaxBaseError =
    0.5;                        // of a bump's height, by which the ground around it may be uneven
constexpr double kSame = 1e-4;  // [m] between heights that are the same

/// The driven line of one path, at equal steps: the ground below the middle of the rear axle.
struct DrivenProfile {
  std::vector<Eigen::Vector3d> points;  ///< [m] in site, on the surface
  std::vector<double> yaws;             ///< [rad]
};

std::vector<DrivenProfile> ProfilesOf(const DrivenPath& path, const CellFinder& cells,
                                      double spacing) {
  std::vector<DrivenProfile> profiles(1);
  std::optional<Eigen::Vector3d> last;
  for (const TrajectoryState& state : path.site_from_body.states()) {
    const Rigid3 site_from_ground = state.world_from_body * path.body_from_ground;
    const Eigen::Vector3d here = site_from_ground.translation;
    if (!last) last = here;
    const double step = (here - *last).head<2>().norm();
    if (step < spacing) continue;
    const Eigen::Vector3d forward = site_from_ground.rotation * Eigen::Vector3d::UnitX();
    const double yaw = std::atan2(forward.y(), forward.x());
    if (step > 5 * spacing || (here - *last).dot(forward) < 0)
      profiles.emplace_back();  // a jump, or in reverse
    const int count = static_cast<int>(step / spacing);
    for (int i = 1; i <= count; ++i) {
      Eigen::Vector3d point = *last + (i * spacing / step) * (here - *last);
      if (const SurfaceCell* cell = cells.Find(point))
        point.z() = static_cast<double>(cell->height);
      profiles.back().points.push_back(point);
      profiles.back().yaws.push_back(yaw);
    }
    *last += (count * spacing / step) * (here - *last);
  }
  return profiles;
}

/// A straight line through the ground before and behind [begin, end], and how far that ground lies
/// off it.
struct BaseLine {
  double offset = 0, slope = 0, rmse = 0;
  double At(double index) const { return offset + slope * index; }
};

std::optional<BaseLine> FitBase(const DrivenProfile& profile, int begin, int end, int reach) {
  if (begin - reach < 0 || end + reach >= static_cast<int>(profile.points.size())) return {};
  double count = 0, sum_x = 0, sum_z = 0, sum_xx = 0, sum_xz = 0, sum_zz = 0;
  for (const auto& [first, last] : {std::pair(begin - reach, begin), {end, end + reach}})
    for (int i = first; i <= last; ++i) {
      const double z = profile.points[static_cast<std::size_t>(i)].z() - profile.points.front().z();
      count += 1, sum_x += i, sum_z += z, sum_xx += static_cast<double>(i) * i, sum_xz += i * z,
          sum_zz += z * z;
    }
  BaseLine line;
  line.slope = (count * sum_xz - sum_x * sum_z) / (count * sum_xx - sum_x * sum_x);
  const double offset = (sum_z - line.slope * sum_x) / count;
  line.rmse = std::sqrt(std::max(0.0, (sum_zz - offset * sum_z - line.slope * sum_xz) / count));
  line.offset = offset + profile.points.front().z();
  return line;
}

/// The bump whose crest is at `crest`, of the length that makes it the highest; nothing where there
/// is none.
std::optional<SpeedBump> MeasureBump(const DrivenProfile& profile, int crest,
                                     const SpeedBumpOptions& options) {
  const int reach = static_cast<int>(std::ceil(kBaseReach / options.spacing));
  const int half = static_cast<int>(0.5 * options.max_length / options.spacing);
  const std::optional<BaseLine> base = FitBase(profile, crest - half, crest + half, reach);
  if (!base) return {};
  const auto above = [&](int i) {
    return profile.points[static_cast<std::size_t>(i)].z() - base->At(i);
  };
  const double height = above(crest);
  if (height < options.min_height || height > options.max_height ||
      base->rmse > kMaxBaseError * height)
    return {};
  int begin = crest, end = crest;
  while (begin > crest - half && above(begin) > kFootShare * height) --begin;
  while (end < crest + half && above(end) > kFootShare * height) ++end;
  // Only the first place of a flat crest counts.
  int last = crest;
  for (int i = begin; i <= end; ++i) {
    if (above(i) > height + kSame || (i < crest && above(i) > height - kSame)) return {};
    if (above(i) > height - kSame) last = i;
  }
  if (begin == crest - half || end == crest + half) return {};
  const auto middle = static_cast<std::size_t>((crest + last) / 2);
  return SpeedBump{profile.points[middle], profile.yaws[middle], height,
                   (end - begin) * options.spacing, 1};
}

/// Adds one pass to the bump that it is of, or as a new one.
void Merge(const SpeedBump& pass, std::vector<SpeedBump>& bumps) {
  for (SpeedBump& bump : bumps) {
    const Eigen::Vector2d apart = (pass.crest - bump.crest).head<2>();
    const double along =
        std::abs(apart.dot(Eigen::Vector2d(std::cos(bump.yaw), std::sin(bump.yaw))));
    if (along > kSameBump || apart.norm() > 3 * kSameBump) continue;
    if (std::abs(pass.crest.z() - bump.crest.z()) > kSameHeight) continue;
    const double share = 1.0 / (bump.num_passes + 1);
    bump.height += share * (pass.height - bump.height);
    bump.length += share * (pass.length - bump.length);
    ++bump.num_passes;
    return;
  }
  bumps.push_back(pass);
}

}  // namespace

void SpeedBumpOptions::Validate() const {
  Require(min_height > 0 && max_height > min_height, ErrorCode::kUsage,
          "bumps: 0 < min_height < max_height");
  Require(spacing > 0 && max_length > 4 * spacing, ErrorCode::kUsage,
          "bumps: max_length must exceed four spacings");
}

std::vector<SpeedBump> FindSpeedBumps(const SurfaceMap& surface, std::span<const DrivenPath> paths,
                                      const SpeedBumpOptions& options) {
  options.Validate();
  const CellFinder cells(surface);
  std::vector<SpeedBump> bumps;
  for (const DrivenPath& path : paths)
    for (const DrivenProfile& profile : ProfilesOf(path, cells, options.spacing))
      for (int i = 0; i < static_cast<int>(profile.points.size()); ++i)
        if (const std::optional<SpeedBump> bump = MeasureBump(profile, i, options))
          Merge(*bump, bumps);
  return bumps;
}

}  // namespace parkade

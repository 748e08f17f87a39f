#include "server/compare/align_maps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/error.h"
#include "core/math/statistics.h"
#include "core/trajectory.h"
#include "core/yaw.h"
#include "mapping/evaluation/surface_rise.h"
#include "server/map_folder/site_keyframes.h"
#include "slam/sessions/register_sites.h"

namespace parkade {
namespace {

constexpr double kPosesApart = 0.2;  // [s] between poses that are compared
constexpr double kDatumsApart =
    20000;  // [m] beyond which two tangent planes count as different towns
constexpr double kMedianToSigma = 1.48;  // of the absolute values of a normal distribution

SharedDrive PairPoses(const std::string& drive, const MapReader& from, const MapReader& to) {
  const Trajectory in_from = from.ReadTrajectory(drive), in_to = to.ReadTrajectory(drive);
  SharedDrive shared{drive, {}};
  std::optional<Timestamp> last;
  for (const TrajectoryState& state : in_to.states()) {
    if (last && state.time - *last < kPosesApart) continue;
    last = state.time;
    if (const std::optional<Rigid3> pose = in_from.At(state.time))
      shared.poses.push_back({*pose, state.world_from_body});
  }
  return shared;
}

/// Takes medians over all poses: a stretch that moved does not move the rest.
SiteAlignment AlignByDrives(const std::vector<SharedDrive>& drives) {
  std::vector<PosePair> pairs;
  for (const SharedDrive& drive : drives)
    pairs.insert(pairs.end(), drive.poses.begin(), drive.poses.end());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  std::vector<double> turns;
  for (const PosePair& pair : pairs) {
    turns.push_back(YawOf(pair.in_to.rotation * pair.in_from.rotation.conjugate()));
    mean += Eigen::Vector2d(std::cos(turns.back()), std::sin(turns.back()));
  }
  const double center = std::atan2(mean.y(), mean.x());
  for (double& turn : turns) turn = std::remainder(turn - center, 2 * M_PI);
  SiteAlignment alignment{.to_from_from = {}, .aligned_by = "drives", .note = ""};
  alignment.to_from_from.rotation =
      Eigen::AngleAxisd(center + Median(turns), Eigen::Vector3d::UnitZ());
  Eigen::Vector3d spread;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> shifts;
    for (const PosePair& pair : pairs)
      shifts.push_back((pair.in_to.translation -
                        alignment.to_from_from.rotation * pair.in_from.translation)[axis]);
    alignment.to_from_from.translation[axis] = Median(shifts);
    for (double& shift : shifts) shift = std::abs(shift - alignment.to_from_from.translation[axis]);
    spread[axis] = kMedianToSigma * Median(std::move(shifts));
  }
  alignment.horizontal_sigma = spread.head<2>().norm() / std::sqrt(2.0);
  alignment.height_sigma = spread.z();
  return alignment;
}

/// The alignment by the two datums; nothing where a map has none, or where they contradict each
/// other.
std::optional<SiteAlignment> AlignByDatum(const MapReader& from, const MapReader& to) {
  if (!from.datum() || !to.datum()) return std::nullopt;
  SiteAlignment alignment{.to_from_from = {}, .aligned_by = "datum", .note = ""};
  alignment.to_from_from = EarthFromSite(*to.datum()).Inverse() * EarthFromSite(*from.datum());
  const double apart = alignment.to_from_from.translation.head<2>().norm();
  Require(apart < kDatumsApart, ErrorCode::kInvalidInput,
          "the two maps lie " + std::to_string(std::lround(apart / 1000)) + " km apart");
  const Eigen::Vector3d sigma = from.PlacementSigma().cwiseAbs2() + to.PlacementSigma().cwiseAbs2();
  alignment.horizontal_sigma = std::sqrt(0.5 * (sigma.x() + sigma.y()));
  alignment.height_sigma = std::sqrt(sigma.z());
  return alignment;
}

std::string Sentence(const char* format, double value) {
  char text[256];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Moves heights so that the grounds lie on each other in the median.
void LevelByGround(const MapReader& from, const MapReader& to, SiteAlignment& alignment) {
  if (const std::optional<double> rise =
          MedianRise(from.ReadSurfaceMap(), to.ReadSurfaceMap(), alignment.to_from_from))
    alignment.to_from_from.translation.z() += *rise;
}

}  // namespace

bool BothHold(const MapReader& a, const MapReader& b, const std::string& drive) {
  return a.Holds(drive, b.LogOf(drive)) && b.Holds(drive, a.LogOf(drive));
}

std::vector<SharedDrive> FindSharedDrives(const MapReader& from, const MapReader& to) {
  std::vector<SharedDrive> shared;
  for (const std::string& drive : to.drives()) {
    if (!BothHold(from, to, drive)) continue;
    SharedDrive pair = PairPoses(drive, from, to);
    if (!pair.poses.empty()) shared.push_back(std::move(pair));
  }
  return shared;
}

SiteAlignment AlignMaps(const std::vector<SharedDrive>& shared, const MapReader& from,
                        const MapReader& to) {
  if (!shared.empty()) return AlignByDrives(shared);
  const std::optional<SiteAlignment> on_earth = AlignByDatum(from, to);
  std::optional<SitePrior> prior;
  if (on_earth) prior = SitePrior{on_earth->to_from_from, on_earth->horizontal_sigma};
  if (const auto found = RegisterSites(ReadSiteKeyframes(from), ReadSiteKeyframes(to), {},
                                       RelativePoseOptions{}, prior))
    return {found->to_from_from, "places",         found->horizontal_sigma,
            found->height_sigma, found->num_links, ""};
  Require(on_earth.has_value(), ErrorCode::kInvalidInput,
          "the two maps share no drive, no place of one was recognized in the other, and they do "
          "not both lie on "
          "Earth: nothing says how they lie to each other");
  Require(from.datum()->is_altitude_known && to.datum()->is_altitude_known,
          ErrorCode::kInvalidInput,
          "the two maps share no drive, no place of one was recognized in the other, and nobody "
          "said how high one of "
          "them lies: pin it with heights");
  SiteAlignment alignment = *on_earth;
  LevelByGround(from, to, alignment);
  alignment.note = Sentence(
      "The two maps are not registered to each other: no place of one was recognized in the other, "
      "and where they lie "
      "on Earth is known to %.1f m only, so that smaller changes are left out.",
      alignment.horizontal_sigma);
  return alignment;
}

}  // namespace parkade

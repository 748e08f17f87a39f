#include "slam/georeference/gnss_doubts.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "core/geo.h"
#include "core/math/statistics.h"
#include "slam/georeference/align_points.h"
#include "slam/georeference/align_to_gnss.h"

namespace parkade {
namespace {

constexpr size_t kMinFixes = 5;
constexpr double kMinExtent = 4;       // [m] of the drive, from its middle
constexpr double kExtentPerSigma = 4;  // a drive must be that large beside the fixes' noise
constexpr double kBelieved = 0.6;      // share of the fixes that must agree
constexpr double kFits = 0.15;         // [m/m] misfit of the track, of the drive's extent
constexpr double kContradicts = 0.35;
constexpr double kRadian = 180 / std::numbers::pi;

/// A reading of what a receiver wrote.
struct Reading {
  const char* looks_like;
  std::function<void(GnssFix&)> correct;
};

const std::vector<Reading>& Readings() {
  static const std::vector<Reading> readings = {
      {"latitude and longitude have changed places",
       [](GnssFix& fix) { std::swap(fix.latitude_deg, fix.longitude_deg); }},
      {"latitude and longitude are in radians",
       [](GnssFix& fix) {
         fix.latitude_deg *= kRadian;
         fix.longitude_deg *= kRadian;
       }},
      {"latitude and longitude are in degrees and minutes, ddmm.mmmm", [](GnssFix& fix) {
         for (double* angle : {&fix.latitude_deg, &fix.longitude_deg}) {
           const double degrees = std::trunc(*angle / 100);
           *angle = degrees + (*angle - 100 * degrees) / 60;
         }
       }}};
  return readings;
}

Eigen::Matrix3Xd InPlane(const std::vector<GnssFix>& fixes) {
  const SiteDatum datum{fixes.front().latitude_deg, fixes.front().longitude_deg, 0};
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(fixes.size()));
  for (size_t i = 0; i < fixes.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) =
        SiteFromGeodetic(datum, fixes[i].latitude_deg, fixes[i].longitude_deg, 0);
  return points;
}

/// [m] of the points from their middle, the median.
double ExtentOf(const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d middle = points.rowwise().mean();
  std::vector<double> distances;
  for (const auto& point : points.colwise()) distances.push_back((point - middle).head<2>().norm());
  return Median(distances);
}

/// [m] by which the best part of the fixes misses the track, once turned and moved onto it.
double MisfitOf(const Eigen::Matrix3Xd& track, const Eigen::Matrix3Xd& points) {
  const Eigen::Index count = points.cols();
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
  const Eigen::VectorXd vertical = Eigen::VectorXd::Ones(count);
  double misfit = 0;
  for (int round = 0; round < 6; ++round) {
    const Rigid3 points_from_track = AlignYawAndTranslation(track, points, weights, vertical);
    std::vector<double> errors;
    for (Eigen::Index i = 0; i < count; ++i)
      errors.push_back((points_from_track * track.col(i) - points.col(i)).head<2>().norm());
    std::vector<double> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    misfit = sorted[static_cast<size_t>(kBelieved * static_cast<double>(count - 1))];
    for (Eigen::Index i = 0; i < count; ++i)
      weights[i] = errors[static_cast<size_t>(i)] <= misfit ? 1 : 1e-6;
  }
  return misfit;
}

std::vector<GnssFix> Corrected(std::vector<GnssFix> fixes, const Reading& reading) {
  for (GnssFix& fix : fixes) reading.correct(fix);
  return fixes;
}

}  // namespace

std::string DoubtOfFixes(const Trajectory& odom_from_body, const std::vector<GnssFix>& fixes,
                         double max_sigma) {
  std::vector<GnssFix> seen;
  std::vector<double> sigmas;
  for (const GnssFix& fix : fixes) {
    if (!IsUsable(fix, odom_from_body, max_sigma)) continue;
    seen.push_back(fix);
    sigmas.push_back(fix.sigma_enu.head<2>().maxCoeff());
  }
  if (seen.size() < kMinFixes) return "";
  Eigen::Matrix3Xd track(3, static_cast<Eigen::Index>(seen.size()));
  for (size_t i = 0; i < seen.size(); ++i)
    track.col(static_cast<Eigen::Index>(i)) = odom_from_body.At(seen[i].time)->translation;
  const double extent = ExtentOf(track);
  if (extent < kMinExtent || extent < kExtentPerSigma * Median(sigmas)) return "";

  const Eigen::Matrix3Xd points = InPlane(seen);
  const double misfit = MisfitOf(track, points);
  if (misfit < kFits * extent) return "";
  for (const Reading& reading : Readings()) {
    const std::vector<GnssFix> corrected = Corrected(seen, reading);
    if (std::any_of(corrected.begin(), corrected.end(), [](const GnssFix& fix) {
          return !(std::abs(fix.latitude_deg) <= 90 && std::abs(fix.longitude_deg) <= 360);
        }))
      continue;
    if (MisfitOf(track, InPlane(corrected)) < kFits * extent)
      return std::string("contradict the trajectory: ") + reading.looks_like + ", as it seems";
  }
  if (ExtentOf(points) < 0.05 * extent)
    return "stay at one spot while the car drives " +
           std::to_string(std::lround(odom_from_body.Length())) + " m: check the receiver";
  if (misfit > kContradicts * extent)
    return "contradict the trajectory, most of them by more than " +
           std::to_string(std::lround(misfit)) + " m: check the receiver and its antenna";
  return "";
}

}  // namespace parkade

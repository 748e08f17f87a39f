#include "mapping/heights/estimate_suspension.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kPoseDistance = 1.0;  // [m] of travel between poses that are asked
constexpr double kReach = 8.0;         // [m]
constexpr double kSquare = 1.2;        // [m] one height of each square is enough
constexpr double kKnownSigma = 0.03;   // [m] of a measured height
constexpr double kNearSigma = 0.02;    // [m] of a plane against the road, near the car ...
constexpr double kCurvature = 0.007;   // [1/m] ... and how the road leaves it
constexpr double kPriorLean = 0.004;   // [rad/(m/s^2)] one sigma of what springs do
constexpr double kSharedErrors = 30;   // heights around one pose err alike
constexpr double kOutlier = 0.1;       // [m]
constexpr size_t kMinHeights = 30;
constexpr double kLeastPlaneErrors = 0.1;
constexpr int kNumRounds = 3;

using Squares = std::map<std::pair<int, int>, std::vector<Eigen::Vector3d>>;

std::pair<int, int> SquareOf(const Eigen::Vector3d& point) {
  return {static_cast<int>(std::floor(point.x() / kSquare)),
          static_cast<int>(std::floor(point.y() / kSquare))};
}

/// A height per square and deck.
Squares SortHeights(std::span<const HeightObservation> heights, size_t& count) {
  Squares squares;
  for (const HeightObservation& height : heights) {
    if (height.Sigma() > kKnownSigma) continue;
    std::vector<Eigen::Vector3d>& here = squares[SquareOf(height.point_in_site)];
    const bool is_new = std::none_of(here.begin(), here.end(), [&](const Eigen::Vector3d& other) {
      return std::abs(other.z() - height.point_in_site.z()) < 1;
    });
    if (is_new) here.push_back(height.point_in_site), ++count;
  }
  return squares;
}

/// One row of the regression: what a pose's plane says too much, and by which lean it would.
struct Row {
  Eigen::Vector3d lift_per_lean;
  double lift = 0, weight = 0;
};

void AddRows(const DrivenPath& path, const TrajectoryState& state, const Squares& squares,
             std::vector<Row>& rows) {
  const Eigen::Vector2d acceleration = AccelerationAt(path.site_from_body, state.time);
  const Rigid3 ground_from_site = (state.world_from_body * path.body_from_ground).Inverse();
  const auto [x, y] = SquareOf(state.world_from_body.translation);
  const int reach = static_cast<int>(std::ceil(kReach / kSquare));
  for (int sx = x - reach; sx <= x + reach; ++sx)
    for (int sy = y - reach; sy <= y + reach; ++sy) {
      const auto found = squares.find({sx, sy});
      if (found == squares.end()) continue;
      for (const Eigen::Vector3d& height : found->second) {
        const Eigen::Vector3d point = ground_from_site * height;
        const double distance = path.contact.DistanceTo(point.head<2>());
        if (distance > kReach || std::abs(point.z()) > 3 * kOutlier) continue;
        const double sigma = std::hypot(kNearSigma, 0.5 * kCurvature * distance * distance);
        rows.push_back({SuspensionModel::LiftPerLean(acceleration, point.head<2>()), -point.z(),
                        1 / (sigma * sigma)});
      }
    }
}

std::vector<Row> MakeRows(const DrivenPath& path, const Squares& squares) {
  std::vector<Row> rows;
  const TrajectoryState* last = nullptr;
  for (const TrajectoryState& state : path.site_from_body.states()) {
    if (last && (state.world_from_body.translation - last->world_from_body.translation).norm() <
                    kPoseDistance)
      continue;
    last = &state;
    AddRows(path, state, squares, rows);
  }
  return rows;
}

Eigen::Vector3d FitLean(const std::vector<Row>& rows) {
  Eigen::Vector3d lean = Eigen::Vector3d::Zero();
  for (int round = 0; round < kNumRounds; ++round) {
    Eigen::Matrix3d left = Eigen::Matrix3d::Identity() / (kPriorLean * kPriorLean);
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Row& row : rows) {
      const double off = round == 0 ? 0 : (row.lift - row.lift_per_lean.dot(lean)) / kOutlier;
      const double weight = row.weight / ((1 + off * off) * (1 + off * off) * kSharedErrors);
      left += weight * row.lift_per_lean * row.lift_per_lean.transpose();
      right += weight * row.lift * row.lift_per_lean;
    }
    lean = left.ldlt().solve(right);
  }
  return lean;
}

/// How far planes that lean err, in their sigmas.
double ErrorsOf(const std::vector<Row>& rows, const Eigen::Vector3d& lean) {
  if (rows.empty()) return 1;
  std::vector<double> ratios;
  ratios.reserve(rows.size());
  for (const Row& row : rows)
    ratios.push_back(std::abs(row.lift - row.lift_per_lean.dot(lean)) * std::sqrt(row.weight));
  constexpr double kOneSigma = 0.683;
  const auto rank = static_cast<size_t>(kOneSigma * static_cast<double>(ratios.size()));
  return std::clamp(NthSmallest(ratios, rank), kLeastPlaneErrors, 1.0);
}

}  // namespace

SuspensionFit EstimateSuspension(const DrivenPath& path,
                                 std::span<const HeightObservation> heights) {
  size_t count = 0;
  const Squares squares = SortHeights(heights, count);
  if (count < kMinHeights) return {};
  const std::vector<Row> rows = MakeRows(path, squares);
  const Eigen::Vector3d lean = FitLean(rows);
  return {{lean[0], lean[1], lean[2]}, ErrorsOf(rows, lean)};
}

}  // namespace parkade

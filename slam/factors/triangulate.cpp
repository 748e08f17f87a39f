#include "slam/factors/triangulate.h"

#include <algorithm>
#include <cmath>

#include "core/math/decompositions.h"

namespace parkade {
namespace {

// Parallax below this many standard deviations says nothing about distance.
constexpr double kMinParallaxSigmas = 4;
constexpr int kReweightings = 3;

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

bool Explains(std::span<const ObservationRay> rays, const Eigen::Vector3d& point, double max_error,
              double min_distance) {
  return std::all_of(rays.begin(), rays.end(), [&](const ObservationRay& ray) {
    const Eigen::Vector3d offset = point - ray.origin;
    return ray.direction.dot(offset) > min_distance &&
           AngleBetween(ray.direction, offset) < max_error * ray.sigma;
  });
}

}  // namespace

std::optional<Triangulated> Triangulate(std::span<const ObservationRay> rays, double max_error,
                                        double min_distance) {
  if (rays.size() < 2) return std::nullopt;
  Triangulated result;
  double sigma = 0;
  for (const ObservationRay& ray : rays) {
    result.parallax =
        std::max(result.parallax, AngleBetween(ray.direction, rays.front().direction));
    sigma = std::max(sigma, ray.sigma);
  }
  if (result.parallax < kMinParallaxSigmas * sigma) return result;

  // Least squares of the distance to each ray, reweighted to angles.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::vector<double> weights(rays.size(), 1.0);
  for (int pass = 0; pass < kReweightings; ++pass) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Matrix3d across =
          weights[i] *
          (Eigen::Matrix3d::Identity() - rays[i].direction * rays[i].direction.transpose());
      normal += across;
      right += across * rays[i].origin;
    }
    point = SolveSymmetric(normal, right);
    if (!point.allFinite()) return std::nullopt;
    for (size_t i = 0; i < rays.size(); ++i)
      weights[i] =
          1 /
          std::max((point - rays[i].origin).squaredNorm() * rays[i].sigma * rays[i].sigma, 1e-12);
  }
  if (!Explains(rays, point, max_error, min_distance)) {
    // Rays that would meet behind the camera, or out of range, may still agree on infinity.
    const bool is_far = std::all_of(rays.begin(), rays.end(), [&](const ObservationRay& ray) {
      return AngleBetween(ray.direction, rays.front().direction) < max_error * ray.sigma;
    });
    if (is_far) return result;
    return std::nullopt;
  }
  result.inverse_distance = 1 / (point - rays.front().origin).norm();
  return result;
}

}  // namespace parkade

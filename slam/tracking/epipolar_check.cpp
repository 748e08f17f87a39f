#include "slam/tracking/epipolar_check.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/math/decompositions.h"
#include "core/rigid3.h"

namespace parkade {
namespace {

constexpr size_t kMinPairs = 8;
constexpr int kNumSamples = 80;          ///< two-point samples: 99.9 % for 70 % outliers
constexpr double kMinAgreement = 0.4;    ///< of all pairs, below which the check is not trusted
constexpr double kRotationSigma = 0.01;  ///< [rad] of the predicted rotation
constexpr double kMinSine = 0.05;        ///< near the epipole the plane is not defined

/// Camera motion without its length.
struct Motion {
  Eigen::Matrix3d rotation;   ///< now_from_last
  Eigen::Vector3d direction;  ///< unit, in now
};

/// [px] distance of `now` off the plane through `direction` and the turned bearing.
double ErrorOf(const BearingPair& pair, const Eigen::Vector3d& turned,
               const Eigen::Vector3d& direction) {
  const Eigen::Vector3d normal = direction.cross(turned);
  return pair.now.dot(normal) / std::max(normal.norm(), kMinSine) / pair.radians_per_pixel;
}

std::vector<Eigen::Vector3d> Turn(const std::vector<BearingPair>& pairs,
                                  const Eigen::Matrix3d& rotation) {
  std::vector<Eigen::Vector3d> turned;
  turned.reserve(pairs.size());
  for (const BearingPair& pair : pairs) turned.push_back(rotation * pair.last);
  return turned;
}

/// Sum of squared errors cut at the threshold: the smaller, the better. Where that is not below
/// `limit`, any number that is not.
double CostOf(const std::vector<BearingPair>& pairs, const std::vector<Eigen::Vector3d>& turned,
              const Eigen::Vector3d& direction, double max_error, double limit) {
  double cost = 0;
  for (size_t i = 0; i < pairs.size() && cost < limit; ++i) {
    const double share = ErrorOf(pairs[i], turned[i], direction) / max_error;
    cost += std::min(share * share, 1.0);
  }
  return cost;
}

/// Turns `guess` so that, as far as rotation alone can, pairs coincide: closed
/// steps of reweighted least squares (Cauchy).
Eigen::Matrix3d FitRotationOnly(const std::vector<BearingPair>& pairs, const Eigen::Matrix3d& guess,
                                double max_error) {
  Eigen::Matrix3d rotation = guess;
  for (double scale : {8.0, 4.0, 2.0, 1.0, 1.0}) {
    Eigen::Matrix3d information = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const BearingPair& pair : pairs) {
      const Eigen::Vector3d turned = rotation * pair.last;
      const Eigen::Vector3d step = turned.cross(pair.now) / pair.radians_per_pixel;
      const double share = step.norm() / (scale * max_error);
      const double weight = 1 / (1 + share * share);
      information += weight / (pair.radians_per_pixel * pair.radians_per_pixel) *
                     (Eigen::Matrix3d::Identity() - turned * turned.transpose());
      gradient += weight / pair.radians_per_pixel * step;
    }
    rotation = ExpSo3(SolveSymmetric(information, gradient)).toRotationMatrix() * rotation;
  }
  return rotation;
}

/// A pseudo-random sequence that is the same on every machine (D. Knuth's MMIX).
class Sequence {
 public:
  size_t Below(size_t limit) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<size_t>(state_ >> 33) % limit;
  }

 private:
  std::uint64_t state_ = 20230417;
};

Eigen::Vector3d SampleDirection(const std::vector<BearingPair>& pairs,
                                const std::vector<Eigen::Vector3d>& turned, double max_error) {
  Sequence sequence;
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  double best_cost =
      CostOf(pairs, turned, best, max_error, std::numeric_limits<double>::infinity());
  for (int sample = 0; sample < kNumSamples; ++sample) {
    const size_t i = sequence.Below(pairs.size()), j = sequence.Below(pairs.size());
    const Eigen::Vector3d direction =
        turned[i].cross(pairs[i].now).cross(turned[j].cross(pairs[j].now));
    if (i == j || direction.norm() < 1e-12) continue;
    const double cost = CostOf(pairs, turned, direction.normalized(), max_error, best_cost);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = direction.normalized();
  }
  return best;
}

/// Gauss-Newton on rotation (3) and direction (2) with Cauchy weights whose
/// scale shrinks, and a weak prior that holds the predicted rotation.
Motion Refine(const std::vector<BearingPair>& pairs, Motion motion,
              const Eigen::Matrix3d& predicted, double max_error) {
  for (const double scale : {3.0, 2.0, 1.0, 0.7, 0.7}) {
    const Eigen::Vector3d& t = motion.direction;
    Eigen::Matrix<double, 3, 2> tangent;
    tangent.col(0) = t.unitOrthogonal();
    tangent.col(1) = t.cross(tangent.col(0));
    Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> gradient = Eigen::Matrix<double, 5, 1>::Zero();
    const Eigen::Vector3d turn =
        LogSo3(Eigen::Quaterniond(motion.rotation * predicted.transpose()));
    information.topLeftCorner<3, 3>().diagonal().setConstant(1 / (kRotationSigma * kRotationSigma));
    gradient.head<3>() = -turn / (kRotationSigma * kRotationSigma);
    information.bottomRightCorner<2, 2>().diagonal().setConstant(1e-3);  // no parallax: stay
    for (const BearingPair& pair : pairs) {
      const Eigen::Vector3d turned = motion.rotation * pair.last;
      const double scale_px =
          1 / (std::max(t.cross(turned).norm(), kMinSine) * pair.radians_per_pixel);
      const double error = pair.now.dot(t.cross(turned)) * scale_px;
      Eigen::Matrix<double, 5, 1> jacobian;
      jacobian << t.dot(turned) * pair.now - turned.dot(pair.now) * t,
          tangent.transpose() * turned.cross(pair.now);
      jacobian *= scale_px;
      const double share = error / (scale * max_error);
      const double weight = 1 / (1 + share * share);
      information += weight * jacobian * jacobian.transpose();
      gradient -= weight * error * jacobian;
    }
    const Eigen::Matrix<double, 5, 1> step = information.ldlt().solve(gradient);
    motion.rotation = ExpSo3(step.head<3>()).toRotationMatrix() * motion.rotation;
    motion.direction = (t + tangent * step.tail<2>()).normalized();
  }
  return motion;
}

/// The sign of `direction` that most of the parallax points along.
Eigen::Vector3d OrientTowardFlow(const std::vector<BearingPair>& pairs,
                                 const std::vector<Eigen::Vector3d>& turned,
                                 const Eigen::Vector3d& direction) {
  double along = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d flow = pairs[i].now - turned[i];
    const double share = flow.dot(direction) / pairs[i].radians_per_pixel;
    along += std::clamp(share, -5.0, 5.0);  // [px]; one wild match must not decide
  }
  return along < 0 ? Eigen::Vector3d(-direction) : direction;
}

}  // namespace

EpipolarCheck CheckEpipolarGeometry(const std::vector<BearingPair>& pairs,
                                    const Eigen::Matrix3d& now_from_last, double max_error_px) {
  EpipolarCheck check{std::vector<bool>(pairs.size(), true), now_from_last};
  if (pairs.size() < kMinPairs) return check;

  // The prediction may be off (gyro bias before it is known): a rotation fitted
  // to the images alone competes with it.
  Motion best{now_from_last, Eigen::Vector3d::UnitZ()};
  double best_cost = 1e300;
  for (const Eigen::Matrix3d& rotation :
       {now_from_last, FitRotationOnly(pairs, now_from_last, max_error_px)}) {
    const Eigen::Vector3d direction = SampleDirection(pairs, Turn(pairs, rotation), max_error_px);
    const Motion refined = Refine(pairs, {rotation, direction}, now_from_last, max_error_px);
    for (const Motion& motion : {Motion{rotation, direction}, refined}) {
      const double cost =
          CostOf(pairs, Turn(pairs, motion.rotation), motion.direction, max_error_px, best_cost);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = motion;
    }
  }

  check.now_from_last = best.rotation;
  check.direction = OrientTowardFlow(pairs, Turn(pairs, best.rotation), best.direction);
  for (size_t i = 0; i < pairs.size(); ++i) check.agrees[i] = Agrees(check, pairs[i], max_error_px);
  const auto agreeing =
      static_cast<double>(std::count(check.agrees.begin(), check.agrees.end(), true));
  check.is_trusted = agreeing >= kMinAgreement * static_cast<double>(pairs.size());
  if (!check.is_trusted) check = {std::vector<bool>(pairs.size(), true), now_from_last};
  return check;
}

bool Agrees(const EpipolarCheck& check, const BearingPair& pair, double max_error_px) {
  const Eigen::Vector3d turned = check.now_from_last * pair.last;
  const double sine = std::max(turned.cross(check.direction).norm(), kMinSine);
  const double backwards =
      -(pair.now - turned).dot(check.direction) / sine / pair.radians_per_pixel;
  return std::abs(ErrorOf(pair, turned, check.direction)) < max_error_px &&
         backwards < 2 * max_error_px;
}

}  // namespace parkade

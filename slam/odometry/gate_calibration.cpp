#include "slam/odometry/gate_calibration.h"

#include <cmath>
#include <limits>

#include "core/math/decompositions.h"

namespace parkade {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr double kMaxVarianceShare =
    0.7;  // share of the prior's variance that may be left along a direction that moves
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

struct Part {
  const char* name;
  int begin, size;
  double sure;  // sigma at which it is refined
};

constexpr Part kParts[] = {{"rotation", 0, 3, 0.075 * M_PI / 180},
                           {"translation", 3, 3, 0.007},
                           {"time_offset", 6, 1, 0.001},
                           {"line_delay", 7, 1, kUnlimited}};

Vector8d PriorSigmas(const CameraSettings& settings) {
  Vector8d sigmas;
  sigmas << Eigen::Vector3d::Constant(settings.prior.rotation),
      Eigen::Vector3d::Constant(settings.prior.translation), settings.prior.time_offset,
      settings.prior.line_delay;
  return sigmas;
}

Eigen::Array<bool, 8, 1> Estimated(const CameraSettings& settings) {
  Eigen::Array<bool, 8, 1> estimated = Eigen::Array<bool, 8, 1>::Constant(settings.has_extrinsics);
  estimated[6] = settings.has_time_offset;
  estimated[7] = settings.has_line_delay;
  return estimated;
}

Vector8d Difference(const CameraParameters& to, const CameraParameters& from) {
  Vector8d difference;
  PoseManifold().Minus(to.extrinsics.data(), from.extrinsics.data(), difference.data());
  for (size_t k = 0; k < kTimingSize; ++k)
    difference[6 + static_cast<Eigen::Index>(k)] = to.timing[k] - from.timing[k];
  return difference;
}

/// The covariance in units of the prior's sigmas; a quantity that is not estimated keeps the
/// prior's.
Matrix8d Whitened(const Matrix8d& covariance, const Vector8d& unit,
                  const Eigen::Array<bool, 8, 1>& is_estimated) {
  Matrix8d whitened =
      unit.cwiseInverse().asDiagonal() * covariance * unit.cwiseInverse().asDiagonal();
  for (int k = 0; k < 8; ++k) {
    if (is_estimated[k]) continue;
    whitened.row(k).setZero();
    whitened.col(k).setZero();
    whitened(k, k) = 1;
  }
  return whitened;
}

/// \param variance in units of the prior's variance
CalibratedQuantity::Status StatusOf(const Part& part, const Eigen::VectorXd& variance,
                                    const Eigen::VectorXd& sigma) {
  const auto moved = (variance.array() < kMaxVarianceShare).count();
  if (moved == 0) return CalibratedQuantity::Status::kKept;
  return moved == part.size && (sigma.array() <= part.sure).all()
             ? CalibratedQuantity::Status::kRefined
             : CalibratedQuantity::Status::kPartlyRefined;
}

}  // namespace

GatedCalibration GateCalibration(const std::string& camera, const CameraSettings& settings,
                                 const CameraParameters& rig_parameters,
                                 const CameraParameters& estimate,
                                 const CalibrationCovariance& covariance, const KeptTurn& turn) {
  const Eigen::Array<bool, 8, 1> is_estimated = Estimated(settings);
  const Vector8d prior = PriorSigmas(settings);
  const Vector8d unit = is_estimated.select(prior.array(), 1.0).matrix();
  const Matrix8d model = Whitened(covariance.model, unit, is_estimated);
  const Matrix8d sandwich = Whitened(covariance.sandwich, unit, is_estimated);
  const SymmetricEigen eigen = DecomposeSymmetric(model);
  Matrix8d refine = Matrix8d::Zero();  // projects on the refined directions
  for (int k = 0; k < 8; ++k) {
    const Vector8d direction = eigen.vectors.col(k);
    if (eigen.values[k] < kMaxVarianceShare &&
        direction.dot(sandwich * direction) < kMaxVarianceShare)
      refine += direction * direction.transpose();
  }
  const Vector8d change =
      unit.asDiagonal() *
      (refine * (unit.cwiseInverse().asDiagonal() * Difference(estimate, rig_parameters)));

  GatedCalibration gated{rig_parameters, {camera, {}}};
  PoseManifold().Plus(rig_parameters.extrinsics.data(), change.data(),
                      gated.parameters.extrinsics.data());
  for (size_t k = 0; k < kTimingSize; ++k)
    gated.parameters.timing[k] += change[6 + static_cast<Eigen::Index>(k)];
  const Matrix8d keep = Matrix8d::Identity() - refine;
  Vector8d variance = (refine * sandwich * refine + keep).diagonal();
  const Eigen::Matrix3d imu_from_camera = estimate.ImuFromCamera().rotation.toRotationMatrix();
  variance.head<3>() +=
      (imu_from_camera.transpose() * turn.directions * imu_from_camera).diagonal();
  variance = variance.cwiseMin(1.0);
  for (const Part& part : kParts) {
    const Eigen::VectorXd share = variance.segment(part.begin, part.size);
    const Eigen::VectorXd sigma =
        (share.cwiseSqrt().array() * prior.segment(part.begin, part.size).array()).matrix();
    gated.report.quantities.push_back(
        {part.name, change.segment(part.begin, part.size), sigma, StatusOf(part, share, sigma)});
  }
  return gated;
}

double TimeShiftBetween(const Rig& from, const Rig& to, int camera) {
  const auto index = static_cast<size_t>(camera);
  return to.cameras[index].time_shift - from.cameras[index].time_shift;
}

}  // namespace parkade

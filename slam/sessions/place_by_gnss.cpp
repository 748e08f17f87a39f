#include "slam/sessions/place_by_gnss.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "core/yaw.h"
#include "slam/georeference/align_points.h"

namespace parkade {
namespace {

constexpr int kNumIterations = 5;  // yaw is the only angle: two already leave nothing

Rigid3 TurnedAndMoved(double yaw, const Eigen::Vector3d& translation) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), translation};
}

/// What one drive says: where the center of its fixes lies, and how the group is turned.
struct Opinion {
  double yaw = 0;                                   ///< of site_from_group [rad]
  Eigen::Vector3d center_in_group, center_in_site;  ///< [m]
  Eigen::Matrix4d information;                      ///< of [yaw, center in site]
};

Opinion OpinionOf(const GnssDrive& drive) {
  const auto count = static_cast<Eigen::Index>(drive.in_odom.size());
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(count);
  const Rigid3 group_from_odom = AlignYawAndTranslation(
      Eigen::Map<const Eigen::Matrix3Xd>(drive.in_odom.front().data(), 3, count),
      Eigen::Map<const Eigen::Matrix3Xd>(drive.in_group.front().data(), 3, count), ones, ones);
  const GnssAlignment& gnss = drive.alignment;
  return {.yaw = YawOf(gnss.site_from_odom.rotation) - YawOf(group_from_odom.rotation),
          .center_in_group = group_from_odom * gnss.center_in_odom,
          .center_in_site = gnss.site_from_odom * gnss.center_in_odom,
          .information = gnss.covariance.inverse()};
}

}  // namespace

std::optional<Rigid3> PlaceByGnss(std::span<const GnssDrive> drives) {
  if (drives.empty()) return std::nullopt;
  std::vector<Opinion> opinions;
  for (const GnssDrive& drive : drives) opinions.push_back(OpinionOf(drive));
  double yaw = opinions.front().yaw;
  Eigen::Vector3d translation = opinions.front().center_in_site -
                                TurnedAndMoved(yaw, {0, 0, 0}) * opinions.front().center_in_group;
  for (int iteration = 0; iteration < kNumIterations; ++iteration) {
    Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    for (const Opinion& opinion : opinions) {
      const Eigen::Vector3d arm = TurnedAndMoved(yaw, {0, 0, 0}) * opinion.center_in_group;
      Eigen::Vector4d residual;
      residual << std::remainder(yaw - opinion.yaw, 2 * std::numbers::pi),
          arm + translation - opinion.center_in_site;
      Eigen::Matrix4d jacobian = Eigen::Matrix4d::Identity();
      jacobian(1, 0) = -arm.y();
      jacobian(2, 0) = arm.x();
      hessian += jacobian.transpose() * opinion.information * jacobian;
      gradient += jacobian.transpose() * opinion.information * residual;
    }
    const Eigen::Vector4d step = -hessian.ldlt().solve(gradient);
    yaw += step[0];
    translation += step.tail<3>();
  }
  return TurnedAndMoved(yaw, translation);
}

}  // namespace parkade

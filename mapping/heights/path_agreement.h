#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/trajectory.h"

namespace parkade {

/// Poses of a path by which PathAgreement tells later whether it moved: one every two meters or 0.3
/// rad, and the last.
std::vector<TimedPose> SparsePoses(const Trajectory& site_from_body);

/// Where heights that were measured along an earlier path hold along that of today.
///
/// They go with the pose nearest to them (DriveHeight), and hold where all poses whose views may
/// have measured them would take them to the same place: to 3 mm and 0.2 mrad, and 0.2 mm more per
/// meter of distance. Where the path as a whole has moved or is bent slowly they do.
class PathAgreement {
 public:
  PathAgreement(std::span<const TimedPose> before, const Trajectory& now);

  /// Asks for ground in the frame of today's path. It holds where no pose is near, and nowhere if
  /// one of the poses of before is missing today.
  bool HoldsAt(const Eigen::Vector3d& point_in_site) const;

  /// Places on the path and beside it, half as far apart as views reach.
  std::vector<Eigen::Vector3d> Places() const;

 private:
  struct Pose {
    Rigid3 now;
    Rigid3 now_from_before;  ///< takes points of site from where they lay to where they lie
  };

  template <typename Visitor>
  void VisitNear(const Eigen::Vector3d& point, const Visitor& visit) const;

  std::vector<Pose> poses_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> squares_;  ///< of the poses
  bool is_whole_ = true;
};

}  // namespace parkade

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/timestamp.h"
#include "core/trajectory.h"
#include "mapping/heights/height_field.h"

namespace parkade {

/// A height that one drive knows, relative to where its car was when it was nearest: it moves with
/// that pose.
struct DriveHeight {
  Timestamp time;
  Eigen::Vector3f point_in_body =
      Eigen::Vector3f::Zero();  ///< [m]; in site where the drive has no path
  float weight = 0;             ///< inverse variance of z [1/m^2]; of planes a sum of them
  float sigma = 0;              ///< [m] as of HeightObservation; of planes the best's
};

/// Ties points of site to the poses of a path that are nearest to them.
class PoseTies {
 public:
  /// The path is borrowed. \param site_from_body  null: points stay in site
  explicit PoseTies(const Trajectory* site_from_body);

  DriveHeight Tie(const HeightObservation& height) const;

 private:
  /// Taken from the squares around a point, or from all where these are empty.
  const TrajectoryState* NearestTo(const Eigen::Vector3d& point) const;

  std::vector<const TrajectoryState*> poses_;
  std::map<std::pair<int, int>, std::vector<const TrajectoryState*>> squares_;
};

/// Where heights of a drive lie now. Many are tied to one pose.
class TiedPoints {
 public:
  /// The path is borrowed. \param site_from_body  null: points are in site
  explicit TiedPoints(const Trajectory* site_from_body) : path_(site_from_body) {}

  /// Nothing where the path does not reach the height's time.
  std::optional<Eigen::Vector3d> InSite(const DriveHeight& height);

 private:
  const Trajectory* path_;
  std::unordered_map<std::int64_t, std::optional<Rigid3>> poses_;
};

}  // namespace parkade

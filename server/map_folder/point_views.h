#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/rig.h"
#include "core/surface_map.h"
#include "core/timestamp.h"
#include "core/trajectory.h"

namespace parkade {

/// The images of one camera, as far as a point's views need them.
struct CameraTimes {
  std::string name;
  double time_shift = 0;         ///< [s] of the log's rig, with which `times` were made
  std::vector<Timestamp> times;  ///< on the IMU's clock, strictly increasing
  cv::Mat mask;                  ///< as RigCamera::mask
};

/// One image that shows a point.
struct PointView {
  std::string camera;
  Timestamp time;         ///< one of CameraTimes::times
  Eigen::Vector2d pixel;  ///< of the image as recorded; (0, 0) is the upper left pixel's center
  double distance = 0;    ///< [m] from the camera
  double view_angle = 0;  ///< [rad] between the line of sight and the vertical: 0 from above
  double resolution = 0;  ///< [px/m] on the ground there, mean of both directions
};

/// Everything that is known of where a drive's cameras were.
struct DriveViews {
  Rig rig;                   ///< refined
  Trajectory site_from_imu;  ///< final
  std::vector<CameraTimes> cameras;
  SurfaceMap surface;  ///< of the whole site: what lies below a deck is hidden by it
};

/// The images that show a point of the site, best resolution first, of each camera at most one in
/// half a second. Rolling shutters are reckoned with. The ground of the map hides what lies behind
/// it; walls, pillars and cars are not in the map: a view may be blocked by them. Linear in the
/// number of images.
std::vector<PointView> FindPointViews(const Eigen::Vector3d& point_in_site, const DriveViews& drive,
                                      size_t limit);

}  // namespace parkade

#include "server/map_folder/point_views.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace parkade {
namespace {

constexpr double kMaxDistance = 30;  // [m] a pixel is as large as a hand there
constexpr double kMargin = 2;        // [px]
constexpr double kMinGap = 0.5;      // [s] between views of one camera: they look alike
constexpr double kOwnGround = 0.3;   // [m] above or below the point: flat rays graze its own ground

/// The view at one pose of the camera, nothing where the camera does not see the point.
std::optional<PointView> ViewFrom(const Rigid3& site_from_camera, const RigCamera& camera,
                                  const Eigen::Vector3d& point_in_site) {
  const Eigen::Vector3d ray = point_in_site - site_from_camera.translation;
  const double distance = ray.norm();
  if (distance > kMaxDistance || distance < 1e-6) return std::nullopt;
  const std::optional<Eigen::Vector2d> pixel =
      camera.model.Project(site_from_camera.Inverse() * point_in_site);
  if (!pixel || !camera.IsUsable(*pixel, kMargin)) return std::nullopt;
  const double steepness = std::abs(ray.z()) / distance;
  const double density = camera.model.PixelsPerRadian(*pixel).value_or(0) / distance;
  return PointView{
      camera.name, {}, *pixel, distance, std::acos(steepness), density * std::sqrt(steepness)};
}

/// The view of the image at `time`, whose rows are exposed one after the other.
std::optional<PointView> ViewAt(Timestamp time, const RigCamera& camera,
                                const Rigid3& imu_from_camera, const Trajectory& site_from_imu,
                                const Eigen::Vector3d& point_in_site) {
  std::optional<PointView> view;
  double delay = 0;  // [s] of the point's row after the middle one
  for (int round = 0; round < (camera.line_delay == 0 ? 1 : 2); ++round) {
    const std::optional<Rigid3> pose = site_from_imu.At(time + delay);
    if (!pose) return std::nullopt;
    view = ViewFrom(*pose * imu_from_camera, camera, point_in_site);
    if (!view) return std::nullopt;
    delay = camera.line_delay * (view->pixel.y() - (camera.model.height() - 1) / 2.0);
  }
  return view;
}

/// Whether the ground lies between two points. Cells are sorted by (y, x, height).
class GroundBetween {
 public:
  explicit GroundBetween(const SurfaceMap& surface) : surface_(surface) {}

  bool operator()(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d ray = point - eye;
    const double length = ray.norm();
    const double step = surface_.cell_size;
    double last = eye.z();
    for (double at = step; at < length; at += step) {
      const Eigen::Vector3d here = eye + ray * (at / length);
      if (std::abs(here.z() - point.z()) < kOwnGround) return false;
      if (Crosses(here, last)) return true;
      last = here.z();
    }
    return false;
  }

 private:
  /// Whether a cell of this column lies between the height before and the one here.
  bool Crosses(const Eigen::Vector3d& here, double last) const {
    const int x = static_cast<int>(std::floor(here.x() / surface_.cell_size));
    const int y = static_cast<int>(std::floor(here.y() / surface_.cell_size));
    const double low = std::min(here.z(), last), high = std::max(here.z(), last);
    const auto first = std::lower_bound(
        surface_.cells.begin(), surface_.cells.end(), std::tuple(y, x, low),
        [](const SurfaceCell& cell, const auto& key) {
          return std::tuple(cell.y, cell.x, static_cast<double>(cell.height)) < key;
        });
    return first != surface_.cells.end() && first->y == y && first->x == x && first->height < high;
  }

  const SurfaceMap& surface_;
};

struct Candidate {
  PointView view;
  Eigen::Vector3d eye;  ///< the camera's center in site
};

/// Every image of one camera that would show the point were there nothing in between.
void AddCandidates(const CameraTimes& images, const DriveViews& drive,
                   const Eigen::Vector3d& point_in_site, std::vector<Candidate>& candidates) {
  const auto& cameras = drive.rig.cameras;
  const auto found = std::find_if(cameras.begin(), cameras.end(), [&](const RigCamera& camera) {
    return camera.name == images.name;
  });
  if (found == cameras.end()) return;
  RigCamera camera = *found;
  camera.mask = images.mask;
  const Rigid3 imu_from_camera =
      drive.rig.ImuFromCamera(static_cast<size_t>(found - cameras.begin()));
  const double shift = camera.time_shift - images.time_shift;
  for (const Timestamp time : images.times) {
    std::optional<PointView> view =
        ViewAt(time + shift, camera, imu_from_camera, drive.site_from_imu, point_in_site);
    if (!view) continue;
    view->time = time;
    const Rigid3 site_from_imu = *drive.site_from_imu.At(time + shift);
    candidates.push_back({*view, site_from_imu * imu_from_camera.translation});
  }
}

bool IsNearOne(const PointView& view, const std::vector<PointView>& chosen) {
  return std::any_of(chosen.begin(), chosen.end(), [&](const PointView& other) {
    return other.camera == view.camera && std::abs(other.time - view.time) < kMinGap;
  });
}

}  // namespace

std::vector<PointView> FindPointViews(const Eigen::Vector3d& point_in_site, const DriveViews& drive,
                                      size_t limit) {
  std::vector<Candidate> candidates;
  for (const CameraTimes& camera : drive.cameras)
    AddCandidates(camera, drive, point_in_site, candidates);
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.view.resolution > b.view.resolution; });
  const GroundBetween is_hidden(drive.surface);
  std::vector<PointView> chosen;
  for (const Candidate& candidate : candidates) {
    if (chosen.size() == limit) break;
    if (IsNearOne(candidate.view, chosen) || is_hidden(candidate.eye, point_in_site)) continue;
    chosen.push_back(candidate.view);
  }
  return chosen;
}

}  // namespace parkade

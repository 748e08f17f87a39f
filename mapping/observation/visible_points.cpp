#include "mapping/observation/visible_points.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "mapping/ground/keyframe_picker.h"
#include "mapping/ground/square_index.h"

namespace parkade {
namespace {

constexpr double kKeyframeDistance =
    0.25;  // [m] of travel between masks of one camera that are looked at
constexpr double kMaxDrop =
    3.0;  // [m] of the ground below the camera: the deck below this one is hidden
constexpr double kMinAngle =
    3 * std::numbers::pi / 180;  // [rad] of turning between masks that are looked at
constexpr double kSquare = 4.0;  // [m] of the squares in which points are sorted
constexpr size_t kMasksPerBatch = 16;

/// Points that one mask shows as drivable.
std::vector<size_t> FindShown(const std::vector<Eigen::Vector3d>& points,
                              const SquareIndex<size_t>& squares, const RigCamera& camera,
                              const Rigid3& world_from_camera, const cv::Mat& mask,
                              const VisiblePointsOptions& options) {
  cv::Mat widened;
  cv::dilate(mask, widened, cv::Mat::ones(3, 3, CV_8U));
  const Rigid3 camera_from_world = world_from_camera.Inverse();
  const Eigen::Vector3d eye = world_from_camera.translation;
  std::vector<size_t> shown;
  squares.VisitAround(eye.head<2>(), options.max_distance, [&](size_t i) {
    const Eigen::Vector3d ray = points[i] - eye;
    if (ray.head<2>().norm() > options.max_distance || ray.z() >= 0 || ray.z() < -kMaxDrop) return;
    const std::optional<Eigen::Vector2d> pixel =
        camera.model.Project(camera_from_world * points[i]);
    if (!pixel || !camera.model.IsInImage(*pixel, 1)) return;
    if (widened.at<uchar>(static_cast<int>(std::lround(pixel->y())),
                          static_cast<int>(std::lround(pixel->x()))) >= 128)
      shown.push_back(i);
  });
  return shown;
}

}  // namespace

void VisiblePointsOptions::Validate() const {
  Require(max_distance > 0, ErrorCode::kUsage, "max_distance of visible ground must be > 0 m");
}

Trajectory TrajectoryOf(std::span<const TimedPose> world_from_imu, const Rig& rig) {
  const Rigid3 imu_from_body = rig.body_from_imu.Inverse();
  std::vector<TrajectoryState> states;
  for (const TimedPose& pose : world_from_imu)
    states.push_back({.time = pose.time, .world_from_body = pose.world_from_frame * imu_from_body});
  return Trajectory(std::move(states));
}

std::vector<bool> FindVisiblePoints(const std::vector<Eigen::Vector3d>& points, const DriveLog& log,
                                    std::span<const TimedPose> world_from_imu,
                                    const VisiblePointsOptions& options) {
  options.Validate();
  const Trajectory trajectory = TrajectoryOf(world_from_imu, log.rig());
  SquareIndex<size_t> squares(kSquare);
  for (size_t i = 0; i < points.size(); ++i) squares.Add(points[i].head<2>(), i);
  KeyframePicker picker(trajectory, log.rig().cameras.size(), kKeyframeDistance, kMinAngle);
  const std::unique_ptr<RecordStream> records = log.Read(
      {.imu = false,
       .wheels = false,
       .gnss = false,
       .images = false,
       .semantics = true,
       .grayscale = true,
       .wants_image = [&](int camera, Timestamp time) { return picker.Wants(camera, time); }});
  std::vector<bool> is_seen(points.size());
  size_t num_masks = 0;
  for (bool is_at_end = false; !is_at_end;) {
    std::vector<SemanticFrame> batch;
    while (batch.size() < kMasksPerBatch && !is_at_end) {
      std::optional<SensorRecord> record = records->Next();
      is_at_end = !record.has_value();
      if (record)
        if (auto* mask = std::get_if<SemanticFrame>(&*record)) batch.push_back(std::move(*mask));
    }
    num_masks += batch.size();
    const auto shown = ParallelMap(batch.size(), [&](size_t i) {
      const RigCamera& camera = log.rig().cameras[static_cast<size_t>(batch[i].camera)];
      const std::optional<Rigid3> world_from_body = trajectory.At(batch[i].time);
      if (!world_from_body) return std::vector<size_t>{};
      return FindShown(points, squares, camera, *world_from_body * camera.body_from_camera,
                       batch[i].mask, options);
    });
    for (const std::vector<size_t>& of_mask : shown)
      for (const size_t point : of_mask) is_seen[point] = true;
  }
  Require(num_masks > 0, ErrorCode::kInvalidInput,
          "drive '" + log.name() +
              "' has no masks (<camera>/semantic): what its cameras saw cannot be told");
  return is_seen;
}

}  // namespace parkade

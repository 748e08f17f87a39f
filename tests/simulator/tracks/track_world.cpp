#include "tests/simulator/tracks/track_world.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace parkade::simulator {
namespace {

constexpr unsigned kGround = 0;      // geometry id
constexpr double kOwnCarReach = 20;  // [m]
constexpr double kMinShare = 0.3;    // of the light, where a mask ends: see SampleTable::Mask

RTCRay MakeRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double reach) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x()), ray.org_y = static_cast<float>(origin.y()),
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x()), ray.dir_y = static_cast<float>(direction.y()),
  ray.dir_z = static_cast<float>(direction.z());
  ray.tfar = static_cast<float>(reach);
  ray.mask = ~0u;
  return ray;
}

bool IsBlocked(RTCScene scene, RTCRay ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0;
}

RTCRayHit Intersect(RTCScene scene, const RTCRay& ray) {
  RTCRayHit query{};
  query.ray = ray;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
  return query;
}

}  // namespace

TrackWorld::TrackWorld(const Scene& scene)
    : world_({&scene.ground, &scene.objects}),
      own_car_({&scene.own_car}),
      movers_(scene.movers),
      to_sun_(scene.sky.sun_direction().cast<double>()) {}

bool TrackWorld::OwnCarHides(const Eigen::Vector3d& origin,
                             const Eigen::Vector3d& direction) const {
  return IsBlocked(own_car_.scene(), MakeRay(origin, direction, kOwnCarReach));
}

std::optional<Sight> TrackWorld::Look(const Eigen::Vector3d& origin,
                                      const Eigen::Vector3d& direction) const {
  const RTCRay ray = MakeRay(origin, direction, kSight);
  RTCRayHit hit = Intersect(world_.scene(), ray);
  const bool is_still = hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  Sight sight;
  sight.is_ground = is_still && hit.hit.geomID == kGround;
  if (!movers_.empty()) {
    const RTCRayHit moving = Intersect(movers_.scene(), ray);
    if (moving.hit.geomID != RTC_INVALID_GEOMETRY_ID &&
        (!is_still || moving.ray.tfar < hit.ray.tfar)) {
      hit = moving;
      sight.is_ground = false;
      sight.mover = movers_.placed(moving.hit.instID[0]).mover;
    }
  }
  if (!is_still && !sight.mover) return std::nullopt;
  sight.distance = static_cast<double>(hit.ray.tfar);
  sight.point = origin + sight.distance * direction;
  Eigen::Vector3f normal(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z);
  if (sight.mover) normal = movers_.placed(hit.hit.instID[0]).world_from_mover.rotation * normal;
  sight.normal = normal.cast<double>().normalized();
  if (sight.normal.dot(direction) > 0) sight.normal = -sight.normal;
  return sight;
}

bool TrackWorld::IsHidden(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const {
  const Eigen::Vector3d way = point - eye;
  const double distance = way.norm(),
               reach = std::min(distance - std::max(0.05, 0.01 * distance), kSight);
  if (reach <= 0) return false;
  const RTCRay ray = MakeRay(eye, way / distance, reach);
  return IsBlocked(world_.scene(), ray) || (!movers_.empty() && IsBlocked(movers_.scene(), ray));
}

cv::Mat TrackWorld::OwnCarMask(const RigCamera& camera, double half_field_of_view) const {
  constexpr int kStep = 2;  // [px]
  const CameraModel& model = camera.model;
  cv::Mat mask = cv::Mat::zeros(model.height(), model.width(), CV_8UC1);
  for (int row = 0; row < mask.rows; row += kStep) {
    for (int column = 0; column < mask.cols; column += kStep) {
      const std::optional<Eigen::Vector3d> bearing = model.Unproject({column + 0.5, row + 0.5});
      if (!bearing) continue;
      const double relative = std::acos(std::clamp(bearing->z(), -1.0, 1.0)) / half_field_of_view;
      if ((1 - 0.45 * relative * relative * relative) *
              std::clamp((1 - relative) / 0.03, 0.0, 1.0) <=
          kMinShare)
        continue;
      const Rigid3& body_from_camera = camera.body_from_camera;
      if (IsBlocked(own_car_.scene(), MakeRay(body_from_camera.translation,
                                              body_from_camera.rotation * *bearing, 20)))
        continue;
      mask(cv::Rect(column, row, kStep, kStep) & cv::Rect(0, 0, mask.cols, mask.rows)) = 255;
    }
  }
  cv::erode(mask, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}), {-1, -1}, 1,
            cv::BORDER_REPLICATE);
  return mask;
}

}  // namespace parkade::simulator

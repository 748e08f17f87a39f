#include "server/pipeline/drive_diagnostics.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

/// To `steps` steps per unit, which must be whole for few digits in the file.
double Rounded(double value, double steps) { return std::round(value * steps) / steps; }

/// One series on its way into the file.
class Series {
 public:
  Series(const char* name, const char* unit, const char* about, double steps)
      : json_{{"name", name}, {"unit", unit}, {"about", about}}, steps_(steps) {}

  void SetCamera(const std::string& camera) { json_["camera"] = camera; }
  void Add(double time, double value) {
    if (!std::isfinite(value)) return;
    times_.push_back(Rounded(time, 1e4));
    values_.push_back(Rounded(value, steps_));
  }
  void AppendTo(Json& all) && {
    if (times_.empty()) return;
    json_["times"] = std::move(times_);
    json_["values"] = std::move(values_);
    all.push_back(std::move(json_));
  }

 private:
  Json json_;
  double steps_;
  std::vector<double> times_, values_;
};

void AddOfTrajectory(const Trajectory& site_from_body, Timestamp start, Json& all) {
  Series speed("speed", "m/s", "of the rear axle's center, forward; backwards is negative", 1e3);
  Series position("sigma_position", "m", "horizontal, since the drive's first pose", 1e4);
  Series height("sigma_height", "m", "since the drive's first pose", 1e4);
  Series yaw("sigma_yaw", "rad", "since the drive's first pose", 1e6);
  for (const TrajectoryState& state : site_from_body.states()) {
    const double time = state.time - start;
    const Rigid3& pose = state.world_from_body;
    speed.Add(time, (pose.rotation.conjugate() * state.velocity_in_world).x());
    const auto& covariance = state.covariance;
    position.Add(time, std::sqrt(covariance(3, 3) + covariance(4, 4)));
    height.Add(time, std::sqrt(covariance(5, 5)));
    yaw.Add(time, std::sqrt(covariance(2, 2)));
  }
  for (Series* series : {&speed, &position, &height, &yaw}) std::move(*series).AppendTo(all);
}

void AddOfImages(const std::vector<ImageResidual>& images, const Rig& rig, Timestamp start,
                 Json& all) {
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    Series inliers("inliers", "1", "tracked points of an image that fit the poses", 1);
    Series residual("residual", "rad", "root mean square of these points' directions off the poses",
                    1e7);
    for (Series* series : {&inliers, &residual}) series->SetCamera(rig.cameras[camera].name);
    for (const ImageResidual& image : images) {
      if (image.camera != static_cast<int>(camera)) continue;
      inliers.Add(image.time - start, image.num_inliers);
      if (image.num_inliers > 0) residual.Add(image.time - start, image.rms);
    }
    for (Series* series : {&inliers, &residual}) std::move(*series).AppendTo(all);
  }
}

void AddOfGnss(const GnssPositions& gnss, const Trajectory& site_from_body, Timestamp start,
               const std::optional<SiteDatum>& datum, Json& all) {
  Series sigma("gnss_sigma", "m", "horizontal, as the receiver declares it", 1e4);
  Series error("gnss_error", "m", "horizontal, of a fix off the trajectory's antenna", 1e4);
  for (const GnssFix& fix : gnss.fixes) {
    sigma.Add(fix.time - start, fix.sigma_enu.head<2>().maxCoeff());
    const std::optional<Rigid3> pose = site_from_body.At(fix.time);
    if (!pose || !datum) continue;
    const Eigen::Vector3d off =
        SiteFromGeodetic(*datum, fix.latitude_deg, fix.longitude_deg, fix.altitude) -
        *pose * gnss.antenna_in_body;
    error.Add(fix.time - start, off.head<2>().norm());
  }
  for (Series* series : {&sigma, &error}) std::move(*series).AppendTo(all);
}

Json NumbersOf(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

/// Quaternions as x y z w.
Json PoseToJson(const Rigid3& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"position", NumbersOf(pose.translation)}, {"orientation", {q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace

DriveResiduals MeasureResiduals(const OdometryResult& odometry, const Rig& log_rig,
                                const DriveRefinement& refinement,
                                const RefinementOptions& options) {
  if (!odometry.measurements) return {};
  return {ResidualsOfImages(*odometry.measurements, log_rig, refinement.rig,
                            refinement.odom_from_body, options),
          SlipOfWheels(*odometry.measurements, refinement.rig, refinement.odom_from_body,
                       refinement.wheel_scale)};
}

std::string EncodeDiagnostics(const SiteDrive& drive, const DriveDiagnostics& diagnostics,
                              const OdometryReport& report, const std::optional<SiteDatum>& datum) {
  const Trajectory& site_from_body = drive.site_from_body_trajectory;
  const Timestamp start = site_from_body.span().begin;
  Json series = Json::array();
  AddOfTrajectory(site_from_body, start, series);
  AddOfImages(diagnostics.residuals.images, drive.rig, start, series);
  Series slip("wheel_slip", "m/s", "of the wheels, less the car's speed, while it moves", 1e4);
  for (const WheelSlip& wheels : diagnostics.residuals.wheels)
    slip.Add(wheels.time - start, wheels.speed);
  std::move(slip).AppendTo(series);
  AddOfGnss(diagnostics.gnss, site_from_body, start, datum, series);
  Json degraded = Json::array();
  for (const DegradedInterval& interval : report.degraded)
    degraded.push_back({{"begin", Rounded(interval.begin - start, 1e4)},
                        {"end", Rounded(interval.end - start, 1e4)},
                        {"reason", interval.reason}});
  const Json json = {{"start", ToDecimalSeconds(start)},
                     {"end", Rounded(site_from_body.span().Seconds(), 1e4)},
                     {"degraded", std::move(degraded)},
                     {"series", std::move(series)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string EncodeKeyframes(const SiteDrive& drive,
                            const std::vector<OdometryKeyframe>& keyframes) {
  Json cameras = Json::array(), kept = Json::array();
  for (const RigCamera& camera : drive.rig.cameras) {
    Json json = {
        {"name", camera.name}, {"width", camera.model.width()}, {"height", camera.model.height()}};
    json["body_from_camera"] = PoseToJson(camera.body_from_camera);
    cameras.push_back(std::move(json));
  }
  for (const OdometryKeyframe& keyframe : keyframes) {
    const std::optional<Rigid3> pose = drive.site_from_body_trajectory.At(keyframe.time);
    if (!pose) continue;
    Json json = {{"time", ToDecimalSeconds(keyframe.time)},
                 {"camera", drive.rig.cameras[static_cast<size_t>(keyframe.camera)].name}};
    json["site_from_body"] = PoseToJson(*pose);
    kept.push_back(std::move(json));
  }
  const Json json = {{"cameras", std::move(cameras)}, {"keyframes", std::move(kept)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace parkade

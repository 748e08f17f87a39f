#include "tests/server/worlds/memory_drive.h"

#include <algorithm>
#include <cmath>

#include "slam/factors/motion_state.h"
#include "tests/slam/worlds/rendered_room.h"
#include "tests/support/fisheye_camera.h"

namespace parkade {
namespace {

constexpr double kImuRate = 200, kWheelRate = 50, kCameraRate = 5;  // [Hz]
constexpr int kWidth = 320, kHeight = 200;

class MemoryStream final : public RecordStream {
 public:
  MemoryStream(const std::vector<SensorRecord>& records, ReadOptions options)
      : records_(records), options_(std::move(options)) {}

  std::optional<SensorRecord> Next() override {
    while (next_ < records_.size()) {
      const SensorRecord& record = records_[next_++];
      if (IsWanted(record)) return record;
    }
    return std::nullopt;
  }

 private:
  bool IsWanted(const SensorRecord& record) const {
    if (std::holds_alternative<ImuSample>(record)) return options_.imu;
    if (std::holds_alternative<WheelSample>(record)) return options_.wheels;
    const CameraFrame* frame = std::get_if<CameraFrame>(&record);
    return frame && options_.images &&
           (!options_.wants_image || options_.wants_image(frame->camera, frame->time));
  }

  const std::vector<SensorRecord>& records_;
  ReadOptions options_;
  size_t next_ = 0;
};

RigCamera MakeCamera(const std::string& name, const Eigen::Vector3d& position, double yaw) {
  return MakeFisheyeCamera(name, position, yaw, 0, 100, kWidth, kHeight);
}

Rig HallRig() {
  Rig rig;
  rig.cameras = {MakeCamera("front", {3.5, 0, 0.8}, 0),
                 MakeCamera("left", {1.5, 0.9, 1}, M_PI / 2)};
  rig.imu.topic = "/imu";
  rig.imu.update_rate = kImuRate;
  rig.body_from_imu.translation = {1.2, 0.1, 0.5};
  rig.vehicle.emplace();
  rig.vehicle->wheelbase = 2.8;
  rig.vehicle->track = 1.6;
  rig.vehicle->wheel_topic = "/wheels";
  return rig;
}

Timestamp TimeAt(double seconds) {
  return {1'000'000'000'000 + static_cast<std::int64_t>(std::llround(seconds * 1e9))};
}

ImuSample ImuAt(const Rig& rig, const BodyMotion& motion, Timestamp time) {
  const Eigen::Vector3d& arm = rig.body_from_imu.translation;
  const Eigen::Vector3d& rate = motion.angular_velocity;
  const Eigen::Vector3d gravity(0, 0, -9.81);
  const Eigen::Vector3d force =
      motion.world_from_body.rotation.conjugate() * (motion.acceleration - gravity) +
      motion.angular_acceleration.cross(arm) + rate.cross(rate.cross(arm));
  const Eigen::Quaterniond imu_from_body = rig.body_from_imu.rotation.conjugate();
  return {time, imu_from_body * rate, imu_from_body * force};
}

template <typename Make>
void AddRecords(double rate, double offset, double duration, std::vector<SensorRecord>& records,
                Make make) {
  for (int i = 0; i / rate + offset < duration; ++i) records.emplace_back(make(i / rate + offset));
}

void SortByTime(std::vector<SensorRecord>& records) {
  std::stable_sort(
      records.begin(), records.end(),
      [](const SensorRecord& a, const SensorRecord& b) { return TimeOf(a) < TimeOf(b); });
}

}  // namespace

MemoryDrive::MemoryDrive(std::string name, Rig rig, std::vector<SensorRecord> records)
    : name_(std::move(name)), rig_(std::move(rig)), records_(std::move(records)) {}

TimeSpan MemoryDrive::span() const { return {TimeOf(records_.front()), TimeOf(records_.back())}; }

std::unique_ptr<RecordStream> MemoryDrive::Read(const ReadOptions& options) const {
  return std::make_unique<MemoryStream>(records_, options);
}

DriveLogHealth MemoryDrive::health() const {
  DriveLogHealth health;
  for (const char* role : {"imu", "wheels"}) health.streams.emplace_back().role = role;
  for (const RigCamera& camera : rig_.cameras) health.streams.emplace_back().role = camera.name;
  return health;
}

std::unique_ptr<RecordedDrive> DriveThroughHall(const std::string& name, double duration) {
  const Rig rig = HallRig();
  const MotionFunction motion = CarMotion(duration);
  const RenderedRoom hall({-25, -25, -0.01}, {45, 45, 5}, 3);
  std::vector<SensorRecord> records;
  AddRecords(kImuRate, 0, duration, records,
             [&](double t) { return ImuAt(rig, motion(t), TimeAt(t)); });
  AddRecords(kWheelRate, 0.003, duration, records, [&](double t) {
    const BodyMotion at = motion(t);
    const Eigen::Vector3d in_body = at.world_from_body.rotation.conjugate() * at.velocity;
    return WheelSample{TimeAt(t), in_body.x(), at.angular_velocity.z()};
  });
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const RoomCamera eye(rig.cameras[camera].model, hall);
    AddRecords(kCameraRate, 0.01 + 0.03 * static_cast<double>(camera), duration, records,
               [&](double t) {
                 const Rigid3 hall_from_camera =
                     motion(t).world_from_body * rig.cameras[camera].body_from_camera;
                 return CameraFrame{TimeAt(t), static_cast<int>(camera),
                                    eye.Render(hall_from_camera, 1.0, static_cast<int>(t * 100))};
               });
  }
  SortByTime(records);
  return std::make_unique<MemoryDrive>(name, rig, std::move(records));
}

std::unique_ptr<RecordedDrive> DriveWithoutImages(const std::string& name, double duration) {
  Rig rig = HallRig();
  rig.vehicle->wheel_topic.clear();
  const MotionFunction motion = CarMotion(duration);
  std::vector<SensorRecord> records;
  AddRecords(kImuRate, 0, duration, records,
             [&](double t) { return ImuAt(rig, motion(t + 4), TimeAt(t)); });
  return std::make_unique<MemoryDrive>(name, rig, std::move(records));
}

}  // namespace parkade

#include "tests/bench/ground/large_site.h"

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace parkade {
namespace {

constexpr double kLaneStep = 50, kLaneWidth = 10;  // [m]
constexpr double kSeenBeside = 3;                  // [m] of what is not drivable
constexpr double kSampleStep = 0.05;               // [m]
constexpr double kViewStep = 1;                    // [m]
constexpr double kEyeHeight = 1.5;                 // [m]
constexpr int kWidth = 640, kHeight = 400;

double HeightAt(double x, double y) { return 0.4 * std::sin(x / 25) + 0.3 * std::cos(y / 17); }

bool IsLane(double y) { return y - kLaneStep * std::floor(y / kLaneStep) < kLaneWidth; }

std::uint8_t ShadeAt(double x, double y) {
  if (std::fmod(x, 2.5) < 0.12) return 220;  // paint
  const auto noise = static_cast<std::uint32_t>(std::lround(x / kSampleStep) * 7919 +
                                                std::lround(y / kSampleStep) * 104729);
  return static_cast<std::uint8_t>(90 + (noise * 2654435761U >> 28U));
}

/// A rig of one wide camera that looks ahead and down.
Rig MakeRig() {
  Rig rig;
  RigCamera camera;
  camera.name = "cam0";
  camera.model =
      CameraModel(PinholeProjection{.fx = 260, .fy = 260, .cx = 0.5 * kWidth, .cy = 0.5 * kHeight},
                  kWidth, kHeight);
  const double tilt = 35 * std::numbers::pi / 180;
  Eigen::Matrix3d body_from_camera;
  body_from_camera << 0, -std::sin(tilt), std::cos(tilt), -1, 0, 0, 0, -std::cos(tilt),
      -std::sin(tilt);
  camera.body_from_camera = {Eigen::Quaterniond(body_from_camera), {0, 0, kEyeHeight}};
  rig.cameras.push_back(camera);
  rig.vehicle.emplace();
  rig.vehicle->wheelbase = 2.7;
  rig.vehicle->track = 1.6;
  return rig;
}

/// Lane after lane, each from west to east, at 10 m/s.
Trajectory DriveThrough(double side) {
  std::vector<TrajectoryState> states;
  double seconds = 100;
  for (double y = 0.5 * kLaneWidth; y < side; y += kLaneStep, seconds += 10)
    for (double x = 0; x < side; x += kViewStep, seconds += 0.1 * kViewStep) {
      TrajectoryState& state = states.emplace_back();
      state.time = TimestampFromSeconds(seconds);
      state.world_from_body.translation = {x, y, HeightAt(x, y)};
    }
  return Trajectory(std::move(states));
}

/// From each place the ground from 1 to 8 m ahead.
class LanePatches final : public PatchSource {
 public:
  explicit LanePatches(const DrivenPath& path) {
    for (const TrajectoryState& state : path.site_from_body.states())
      views_.push_back(
          {0, 0, state.time, state.world_from_body,
           ExtentInSite({Eigen::Vector3d(kNear, -kAside, 0), Eigen::Vector3d(kFar, kAside, 0)},
                        state.world_from_body)});
  }

  PosedGroundPatch Read(std::size_t index) const override {
    const PatchView& view = views_[index];
    PosedGroundPatch posed{{view.drive, view.camera, view.time, {}}, view.site_from_body};
    const Eigen::Vector3d& from = view.site_from_body.translation;
    for (double x = kNear; x < kFar; x += kSampleStep)
      for (double y = -kAside; y < kAside; y += kSampleStep) {
        GroundSample& sample = posed.patch.samples.emplace_back();
        sample.point_in_body = Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0);
        sample.blue = sample.green = sample.red = ShadeAt(from.x() + x, from.y() + y);
        sample.is_free = IsLane(from.y() + y);
        sample.weight = static_cast<float>(1e4 / (x * x));
        sample.footprint = static_cast<float>(kSampleStep);
      }
    return posed;
  }

 private:
  static constexpr double kNear = 1, kFar = 8, kAside = 0.5 * kLaneWidth + kSeenBeside;  // [m]
};

/// One image, again and again.
class SameImages final : public RecordStream {
 public:
  SameImages(const Trajectory& trajectory, ReadOptions options)
      : trajectory_(&trajectory), options_(std::move(options)), image_(kHeight, kWidth, CV_8UC3) {
    cv::RNG random(1);
    random.fill(image_, cv::RNG::NORMAL, 110, 12);
  }

  std::optional<SensorRecord> Next() override {
    while (next_ < trajectory_->states().size()) {
      const Timestamp time = trajectory_->states()[next_++].time;
      if (!options_.wants_image || options_.wants_image(0, time))
        return CameraFrame{time, 0, image_};
    }
    return {};
  }

 private:
  const Trajectory* trajectory_;
  ReadOptions options_;
  cv::Mat image_;
  std::size_t next_ = 0;
};

class LaneLog final : public DriveLog {
 public:
  LaneLog(const Rig& rig, const Trajectory& trajectory) : rig_(rig), trajectory_(trajectory) {}
  const std::string& name() const override { return name_; }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override { return trajectory_.span(); }
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override {
    return std::make_unique<SameImages>(trajectory_, options);
  }

 private:
  std::string name_ = "lanes";
  const Rig& rig_;
  const Trajectory& trajectory_;
};

}  // namespace

LargeSite::LargeSite(double hectares)
    : side_(100 * std::sqrt(hectares)),
      rig_(MakeRig()),
      path_(MakeDrivenPath(0, rig_, DriveThrough(side_), {})),
      patches_(std::make_unique<LanePatches>(path_)) {}

std::vector<HeightObservation> LargeSite::Heights() const {
  constexpr double kStep = 0.4;
  std::vector<HeightObservation> heights;
  for (double lane = 0; lane < side_; lane += kLaneStep)
    for (double y = lane - kSeenBeside + 0.5 * kStep; y < lane + kLaneWidth + kSeenBeside;
         y += kStep)
      for (double x = 0.5 * kStep; x < side_ + 8; x += kStep)
        heights.push_back({{x, y, HeightAt(x, y)}, 1e4});
  return heights;
}

std::unique_ptr<DriveLog> LargeSite::Log() const {
  return std::make_unique<LaneLog>(rig_, path_.site_from_body);
}

}  // namespace parkade

#include "tests/simulator/common/fault_options.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace parkade::simulator {
namespace {

void RequireWindow(double begin, double end, const std::string& name) {
  Require(begin >= 0 && end >= begin, ErrorCode::kUsage,
          "faults." + name + " must not end before it begins");
}

void RequireShare(double share, const std::string& name) {
  Require(share >= 0 && share < 1, ErrorCode::kUsage,
          "faults." + name + " must be 0 or more and below 1");
}

bool IsAll(const std::vector<double>& values, double limit) {
  return values.size() <= 4 && std::all_of(values.begin(), values.end(),
                                           [&](double value) { return std::abs(value) <= limit; });
}

}  // namespace

void TimeWindow::Validate() const {
  Require(begin >= 0 && end >= begin, ErrorCode::kUsage,
          "a window of faults must not end before it begins");
}

void FaultOptions::Validate() const {
  Require(IsAll(extrinsic_rotation_deg, 20) && IsAll(extrinsic_translation_cm, 100) &&
              IsAll(time_offsets, 1),
          ErrorCode::kUsage,
          "faults of cameras are lists of at most 4 numbers: at most 20 degrees, 100 cm, 1 s");
  Require(
      mirror.camera >= 0 && mirror.camera < 4 && std::abs(mirror.angle_deg) <= 90 && mirror.at >= 0,
      ErrorCode::kUsage,
      "faults.mirror has a camera 0 to 3, a time, and an angle of at most 90 degrees");
  Require(occlusion.camera >= 0 && occlusion.camera < 4 &&
              (occlusion.kind == "mud" || occlusion.kind == "dark"),
          ErrorCode::kUsage, "faults.occlusion has a camera 0 to 3 and a kind, mud or dark");
  Require(image_gap.camera >= -1 && image_gap.camera < 4, ErrorCode::kUsage,
          "faults.image_gap has a camera 0 to 3, or -1 for all");
  static const std::array<std::string, 8> streams = {"all",  "imu",  "wheels", "gnss",
                                                     "cam0", "cam1", "cam2",   "cam3"};
  Require(std::find(streams.begin(), streams.end(), time_jump.stream) != streams.end(),
          ErrorCode::kUsage, "faults.time_jump.stream is all, imu, wheels, gnss, or cam0 to cam3");
  Require(std::abs(slip.ratio) <= 2, ErrorCode::kUsage, "faults.slip.ratio must be at most 2");
  RequireWindow(occlusion.begin, occlusion.end, "occlusion");
  RequireWindow(image_gap.begin, image_gap.end, "image_gap");
  RequireWindow(time_jump.begin, time_jump.end, "time_jump");
  RequireWindow(slip.begin, slip.end, "slip");
  RequireShare(duplicates, "duplicates");
  RequireShare(unordered, "unordered");
  RequireShare(corrupt_jpegs, "corrupt_jpegs");
  for (const TimeWindow& window : {darkness, imu_gap, wheel_gap, gnss_gap}) window.Validate();
}

double OfCamera(const std::vector<double>& values, size_t camera) {
  if (values.empty()) return 0;
  if (values.size() == 1) return values.front();
  return camera < values.size() ? values[camera] : 0;
}

const char* const kFaultHelp =
    R"(Faults, each by --set faults.NAME=VALUE (times in seconds of the drive):
  extrinsic_rotation_deg=[1,0,0,2]     the rig's cameras are off by so much; one number: all of them
  extrinsic_translation_cm=[2]         the same for their places
  time_offsets=[0.02,-0.01,0,0]        [s] t_imu = stamp + offset, unknown to the rig
  hides_line_delay=true                the rig says nothing of the rolling shutter (--line-delay)
  mirror.camera=1 .at=20 .angle_deg=3  a mirror is knocked in mid-drive
  occlusion.camera=0 .begin=5 .end=60 .kind=mud|dark
  darkness.begin=10 .end=12            all cameras
  image_gap.camera=2 .begin .end       no images (-1: of any camera); imu_gap, wheel_gap, gnss_gap: .begin .end
  time_jump.stream=all .begin .end .seconds=-0.5   stamps go back for a while; all, imu, wheels, gnss, cam0 ...
  slip.begin .end .ratio=0.5           spinning wheels; has_wheels and gnss are under sensors
  duplicates=0.01 unordered=0.01       shares of the records of every sensor
  corrupt_jpegs=0.01                   share of images)";

}  // namespace parkade::simulator

#pragma once

#include <string>
#include <vector>

namespace parkade::simulator {

/// A stretch of the drive; begin = end = 0: never.
struct TimeWindow {
  double begin = 0, end = 0;  ///< [s]

  bool Contains(double time) const { return begin <= time && time < end; }
  bool IsUsed() const { return end > begin; }

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("begin", begin);
    visit("end", end);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// A mirror that is knocked: from then on its camera looks elsewhere.
struct MirrorMove {
  int camera = 1;        ///< index
  double at = 0;         ///< [s]
  double angle_deg = 0;  ///< about a tilted axis through the hinge; 0: never

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("camera", camera);
    visit("at", at);
    visit("angle_deg", angle_deg);
  }
};

struct Occlusion {
  int camera = 0;             ///< index
  double begin = 0, end = 0;  ///< [s]
  std::string kind = "mud";   ///< mud, dark

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("camera", camera);
    visit("begin", begin);
    visit("end", end);
    visit("kind", kind);
  }
};

struct ImageGap {
  int camera = -1;            ///< index; -1: all
  double begin = 0, end = 0;  ///< [s]

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("camera", camera);
    visit("begin", begin);
    visit("end", end);
  }
};

/// Stamps of a stream are wrong by `seconds` for a while.
struct TimeJump {
  std::string stream = "all";  ///< all, imu, wheels, gnss, cam0 ...
  double begin = 0, end = 0;   ///< [s]
  double seconds = -0.5;       ///< negative: back

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("stream", stream);
    visit("begin", begin);
    visit("end", end);
    visit("seconds", seconds);
  }
};

/// Wheels that spin (or lock, ratio < 0), as on ice.
struct StrongSlip {
  double begin = 0, end = 0;  ///< [s]
  double ratio = 0.5;         ///< of speed

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("begin", begin);
    visit("end", end);
    visit("ratio", ratio);
  }
};

/// What goes wrong with a drive. By default nothing. Where a fault concerns the calibration, the
/// rig that is handed out is the wrong (nominal) one.
struct FaultOptions {
  std::vector<double>
      extrinsic_rotation_deg;  ///< per camera; one number: of all. In a random direction
  std::vector<double> extrinsic_translation_cm;  ///< the same
  std::vector<double> time_offsets;  ///< [s] per camera: t_imu = stamp + offset; the rig says 0
  bool hides_line_delay = false;     ///< the rig says 0 although the shutter rolls
  MirrorMove mirror;
  Occlusion occlusion;
  TimeWindow darkness;  ///< of all cameras
  ImageGap image_gap;
  TimeWindow imu_gap, wheel_gap, gnss_gap;
  TimeJump time_jump;
  StrongSlip slip;
  double duplicates = 0;     ///< share of the records of each sensor that is written twice
  double unordered = 0;      ///< share that is written after its successor
  double corrupt_jpegs = 0;  ///< share of images that is damaged or cut off

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("extrinsic_rotation_deg", extrinsic_rotation_deg);
    visit("extrinsic_translation_cm", extrinsic_translation_cm);
    visit("time_offsets", time_offsets);
    visit("hides_line_delay", hides_line_delay);
    visit("mirror", mirror);
    visit("occlusion", occlusion);
    visit("darkness", darkness);
    visit("image_gap", image_gap);
    visit("imu_gap", imu_gap);
    visit("wheel_gap", wheel_gap);
    visit("gnss_gap", gnss_gap);
    visit("time_jump", time_jump);
    visit("slip", slip);
    visit("duplicates", duplicates);
    visit("unordered", unordered);
    visit("corrupt_jpegs", corrupt_jpegs);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Entry `camera` of a list that is empty (0), has one number for all, or one per camera.
double OfCamera(const std::vector<double>& values, size_t camera);

/// For --help: a line for each fault.
extern const char* const kFaultHelp;

}  // namespace parkade::simulator

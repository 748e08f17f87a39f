#pragma once

#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/checks/image_pairs.h"
#include "server/ingest/checks/speed_history.h"

namespace parkade {

/// Whether what cameras see moves as IMU and wheels say that the car does: else topics are swapped,
/// images are turned or mirrored, or the IMU's axes are other ones.
class CameraChecks {
 public:
  explicit CameraChecks(const Rig& rig);

  void Include(const ImuSample& sample) {
    gyroscope_.push_back({sample.time, sample.angular_velocity});
  }
  bool WantsImage(int camera, Timestamp time) const;
  /// \param image  CV_8UC1 of the calibrated size
  void IncludeImage(int camera, Timestamp time, const cv::Mat& image);

  /// \param topics  of the cameras, by their indices
  std::vector<Finding> Findings(const SpeedHistory& wheels,
                                const std::vector<std::string>& topics) const;

 private:
  struct Rate {
    Timestamp time;
    Eigen::Vector3d rate;  ///< [rad/s] in imu
  };

  const Rig& rig_;
  std::vector<ImagePairs> pairs_;  ///< per camera
  std::vector<Rate> gyroscope_;

  friend class MotionJudge;
};

/// Name of the finding about a camera that is left out for it; its topic is the camera's.
inline constexpr const char* kCameraContradicts = "camera_contradicts";

}  // namespace parkade

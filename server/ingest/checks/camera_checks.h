#pragma once

#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/checks/gyroscope_history.h"
#include "server/ingest/checks/image_pairs.h"
#include "server/ingest/checks/speed_history.h"

namespace parkade {

/// Points of a camera that move as foretold, and all that were looked at.
struct PointAgreement {
  int num_agreeing = 0, num_points = 0;
  double share() const {
    return num_points == 0 ? 0 : static_cast<double>(num_agreeing) / num_points;
  }
};

/// What was found about one camera.
struct CameraVerdict {
  PointAgreement agreement;
  std::string looks_like;  ///< the best explanation; empty: none
  bool is_judged = false, is_wrong = false;
  bool is_noise = false;  ///< nothing can be followed; then it is not judged
};

/// Whether what cameras see moves as IMU and wheels say that the car does: else topics are swapped,
/// images are turned or mirrored, or the IMU's axes are other ones.
class CameraChecks {
 public:
  explicit CameraChecks(const Rig& rig);

  void Include(const ImuSample& sample) { gyroscope_.Include(sample); }
  const GyroscopeHistory& gyroscope() const { return gyroscope_; }
  bool WantsImage(int camera, Timestamp time) const;
  void IncludeImage(int camera, Timestamp time, UndecodedImage image);
  /// Looks at the images that wait for it. After the last one, before anything is asked.
  void FollowPairs();

  /// What the cameras themselves say of the car's speeds; empty where no vehicle is known.
  SpeedHistory Speeds() const;

  /// Moments in which wheels say that the car stands, and in most cameras most points move.
  int NumMovingAtRest(const SpeedHistory& wheels) const;

  /// That images of cameras are so noisy that hardly anything can be followed exactly.
  std::vector<Finding> CheckNoise(const std::vector<std::string>& topics) const;

  /// \param topics  of the cameras, by their indices
  /// \param wheels  or what stands for them
  std::vector<Finding> Findings(const SpeedHistory& wheels, const std::vector<std::string>& topics,
                                const std::string& imu_topic) const;

 private:
  struct Verdicts {
    std::vector<CameraVerdict> cameras;
    std::vector<const ImagePairs*> right;  ///< of those that are not wrong; null: of one that is
    int num_wrong = 0, num_judged = 0;
    bool fit_reversed_wheels = false;

    bool AreAllWrong() const { return num_wrong == num_judged; }
  };

  Verdicts VerdictsBy(const GyroscopeHistory& gyroscope, const SpeedHistory& wheels) const;

  const Rig& rig_;
  std::vector<ImagePairs> pairs_;  ///< per camera
  GyroscopeHistory gyroscope_;

  friend class MotionJudge;
};

/// Name of the finding about a camera that is left out for it; its topic is the camera's.
inline constexpr const char* kCameraContradicts = "camera_contradicts";

}  // namespace parkade

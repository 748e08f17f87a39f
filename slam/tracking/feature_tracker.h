#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "slam/tracking/barren_cells.h"
#include "slam/tracking/corner_detector.h"
#include "slam/tracking/ego_mask.h"
#include "slam/tracking/epipolar_check.h"
#include "slam/tracking/feature_track.h"
#include "slam/tracking/feature_tracker_options.h"
#include "slam/tracking/reference_patch.h"
#include "slam/tracking/tracked_image.h"

namespace parkade {

/// What a tracker has met so far. Counts of frames add up to the calls of Track.
struct FeatureTrackerStatistics {
  int frames_tracked = 0;
  int frames_wrong_size = 0;  ///< size or pixel type other than calibrated; skipped
  int frames_blank = 0;       ///< black, white, covered: no contrast at all; skipped
  int frames_duplicate =
      0;             ///< not later than the last, or its pixels repeated while moving; skipped
  int restarts = 0;  ///< times that all tracks were given up after a pause
  std::int64_t tracks_started = 0;
  std::int64_t lost_in_flow = 0;      ///< left the image, or Lucas-Kanade or the round trip failed
  std::int64_t lost_in_geometry = 0;  ///< moved against the epipolar geometry
  std::int64_t lost_on_own_body = 0;
};

/// Follows corners through the images of ONE camera, on locally normalized images: where the
/// predicted rotation and its last parallax lead, a track is aligned with its reference patch; one
/// that does not look like it there, and a new one, by pyramidal Lucas-Kanade with a
/// forward-backward check, and then aligned. Then an epipolar check with the predicted rotation,
/// and new corners where the image is empty and tracks live.
///
/// J.-Y. Bouguet, "Pyramidal implementation of the affine Lucas Kanade feature
/// tracker", 2001; J. Shi, C. Tomasi, "Good features to track", CVPR 1994.
///
/// Deterministic; one thread per tracker. Cameras may run in parallel: track
/// numbers hold the camera index in the bits from 40 up.
class FeatureTracker {
 public:
  /// Throws Error{kUsage} for bad options.
  FeatureTracker(const RigCamera& camera, int camera_index,
                 const FeatureTrackerOptions& options = {});

  /// Tracks into `frame`, then adds corners up to `max_tracks`.
  ///
  /// \param now_from_last_rotation  camera-frame rotation since the frame of the
  ///     previous call (p_now = R p_last), as the gyro predicts it; up to 0.02 rad
  ///     of error is refined away. Rotations over skipped frames are chained here.
  /// \return no observations when the frame was skipped (see the statistics);
  ///     tracks then continue from the frame before. Never throws for bad pixels.
  TrackedFrame Track(const CameraFrame& frame, const Eigen::Matrix3d& now_from_last_rotation);

  /// The last frame that was not skipped, for MatchAcross; empty before the first.
  const TrackedImage& last_image() const { return last_; }

  const FeatureTrackerStatistics& statistics() const { return statistics_; }

 private:
  /// One track of last_ found again.
  struct Found {
    size_t origin = 0;  ///< index into last_.observations
    FeatureObservation observation;
    BearingPair pair;
    std::optional<Eigen::Matrix2d>
        image_from_reference;  ///< where it still looks like its reference
  };

  /// What is remembered of a track beside its last observation.
  struct Memory {
    std::optional<double> parallax;                   ///< in the step into last_; none: new
    std::unique_ptr<const ReferencePatch> reference;  ///< large, and handed on from image to image
    Eigen::Matrix2d image_from_reference = Eigen::Matrix2d::Identity();
  };

  bool IsUsable(const cv::Mat& gray);
  std::vector<std::optional<Eigen::Vector2d>> Predict(double seconds) const;
  std::vector<Found> Follow(const TrackedImage& now,
                            std::vector<std::optional<Eigen::Vector2d>> predicted) const;
  void LearnEgoMask(const std::vector<Found>& found, const EpipolarCheck& check);
  std::vector<Found> Retry(const TrackedImage& now, const std::vector<Found>& found,
                           const std::vector<std::optional<Eigen::Vector2d>>& tried,
                           const EpipolarCheck& check) const;
  void Keep(std::vector<Found> found, const std::vector<std::optional<Eigen::Vector2d>>& tried,
            const EpipolarCheck& check, TrackedImage& now);
  Found Refine(const cv::Mat& image, size_t origin, const Eigen::Vector2d& pixel,
               double max_shift) const;
  static Memory Remember(Memory memory, const Found& track, const cv::Mat& image);
  void AddCorners(TrackedImage& now);
  std::optional<FeatureObservation> Observe(std::int64_t track, const Eigen::Vector2d& pixel) const;

  FeatureTrackerOptions options_;
  CameraModel model_;
  Eigen::Vector3d up_in_camera_;  ///< see TrackedImage
  int camera_ = 0;
  cv::Mat lens_usable_;  ///< of the lens and the rig's mask
  cv::Mat usable_;       ///< lens_usable_ without the own body
  CornerDetector detector_;
  EgoMask ego_mask_;
  BarrenCells barren_;
  TrackedImage last_;
  std::vector<Memory> memories_;  ///< one per observation of last_
  Eigen::Vector3d direction_ =
      Eigen::Vector3d::UnitZ();  ///< of the step into last_, see EpipolarCheck
  double last_seconds_ = 0;      ///< of that step
  cv::Mat last_gray_;            ///< as recorded, to recognize a repeated image
  double median_flow_ = 0;       ///< [px] into last_
  Eigen::Matrix3d now_from_last_ =
      Eigen::Matrix3d::Identity();  ///< since last_, over skipped frames
  std::int64_t next_track_ = 0;
  FeatureTrackerStatistics statistics_;
};

}  // namespace parkade

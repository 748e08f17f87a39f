#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "core/rig.h"
#include "core/timestamp.h"

namespace parkade {

/// Two successive images of a camera, and where points of the first are in the second.
struct ImagePair {
  Timestamp first, second;
  std::vector<Eigen::Vector2d> from, to;  ///< [px]
  std::size_t num_corners = 0;            ///< that were looked for in the second
  double noise = 0;                       ///< [gray levels] of the first

  /// Whether hardly any point moved: the camera stands, or the image is repeated.
  bool IsStill() const;
  /// [px] that half of the points move more than; 0 where there are hardly any.
  double MedianMotion() const;
};

/// Takes pairs of images out of the stream of one camera, all along the drive and not many.
class ImagePairs {
 public:
  explicit ImagePairs(const RigCamera& camera) : camera_(&camera) {}

  /// Whether an image is to be decoded and given to Include.
  bool Wants(Timestamp time) const;
  /// \param image  CV_8UC1 of the calibrated size
  void Include(Timestamp time, const cv::Mat& image);

  const std::vector<ImagePair>& pairs() const { return pairs_; }
  /// [gray levels] in the middle of all pairs; 0 where there are none.
  double Noise() const;

 private:
  void Thin();

  const RigCamera* camera_;
  std::vector<ImagePair> pairs_;
  std::optional<Timestamp> first_;  ///< of a pair that waits for its second image
  cv::Mat first_image_;
  std::optional<Timestamp> next_;  ///< from when on another pair is wanted
  double interval_ = 0.25;         ///< [s] between pairs
};

}  // namespace parkade

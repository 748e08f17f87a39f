#pragma once

#include <Eigen/Core>
#include <functional>
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

/// An image that is decoded only where it is looked at.
struct UndecodedImage {
  /// CV_8UC1 of the calibrated size; empty where it cannot be decoded. Thread-safe.
  std::function<cv::Mat()> decode;
  std::size_t num_bytes = 0;  ///< that are held until then
};

/// Takes pairs of images out of the stream of one camera, all along the drive and not many. How
/// many are too many shows only at its end: until then they wait undecoded.
class ImagePairs {
 public:
  explicit ImagePairs(const RigCamera& camera) : camera_(&camera) {}

  /// Whether an image is to be given to Include.
  bool Wants(Timestamp time) const;
  void Include(Timestamp time, UndecodedImage image);
  std::size_t num_waiting_bytes() const { return num_waiting_bytes_; }
  /// Follows points through all pairs that wait; those that cannot be decoded are dropped. In
  /// parallel.
  void Follow();

  /// The pairs that no longer wait.
  const std::vector<ImagePair>& pairs() const { return pairs_; }
  /// [gray levels] in the middle of all pairs; 0 where there are none.
  double Noise() const;

 private:
  struct Waiting {
    UndecodedImage from, to;
    std::size_t num_bytes() const { return from.num_bytes + to.num_bytes; }
  };

  void Thin();

  const RigCamera* camera_;
  std::vector<ImagePair> pairs_;
  std::vector<std::optional<Waiting>> waiting_;  ///< as pairs_: what is yet to be followed
  std::size_t num_waiting_bytes_ = 0;
  std::optional<Timestamp> first_;  ///< of a pair that waits for its second image
  UndecodedImage first_image_;
  std::optional<Timestamp> next_;  ///< from when on another pair is wanted
  double interval_ = 0.25;         ///< [s] between pairs
};

}  // namespace parkade

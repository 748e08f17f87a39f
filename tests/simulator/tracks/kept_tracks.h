#pragma once

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

namespace parkade::simulator {

/// Which corners to follow (see cv::goodFeaturesToTrack).
struct CornerChoice {
  int most = 200;
  double quality = 0.004;  ///< of the best corner's
  double spacing = 8;      ///< [px]
};

/// Corners of an image and where they went; those that came back to within a pixel of where they
/// were are kept.
struct FollowedCorners {
  std::vector<cv::Point2f> corners, moved;
  std::vector<bool> is_kept;

  int num_corners() const { return static_cast<int>(corners.size()); }
  int num_kept() const {
    return static_cast<int>(std::count(is_kept.begin(), is_kept.end(), true));
  }
};

/// Follows the corners of a gray image within `mask` by OpenCV's Lucas-Kanade into the next image
/// and back.
inline FollowedCorners FollowCorners(const cv::Mat& before, const cv::Mat& after,
                                     const cv::Mat& mask, const CornerChoice& choice = {}) {
  FollowedCorners followed;
  cv::goodFeaturesToTrack(before, followed.corners, choice.most, choice.quality, choice.spacing,
                          mask);
  if (followed.corners.empty()) return followed;
  std::vector<cv::Point2f> back;
  std::vector<std::uint8_t> found, found_back;
  cv::calcOpticalFlowPyrLK(before, after, followed.corners, followed.moved, found, cv::noArray());
  cv::calcOpticalFlowPyrLK(after, before, followed.moved, back, found_back, cv::noArray());
  for (std::size_t i = 0; i < back.size(); ++i)
    followed.is_kept.push_back(found[i] && found_back[i] &&
                               cv::norm(back[i] - followed.corners[i]) < 1);
  return followed;
}

}  // namespace parkade::simulator

#pragma once

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

struct KeptTracks {
  int num_corners = 0, num_kept = 0;
};

/// Of the corners of a grey picture within `mask`, those that OpenCV's Lucas-Kanade follows into the next picture and
/// back to within a pixel of where they were.
inline KeptTracks FollowCorners(const cv::Mat& before, const cv::Mat& after, const cv::Mat& mask,
                                const CornerChoice& choice = {}) {
  std::vector<cv::Point2f> corners, moved, back;
  cv::goodFeaturesToTrack(before, corners, choice.most, choice.quality, choice.spacing, mask);
  KeptTracks tracks{.num_corners = static_cast<int>(corners.size())};
  if (corners.empty()) return tracks;
  std::vector<std::uint8_t> found, found_back;
  cv::calcOpticalFlowPyrLK(before, after, corners, moved, found, cv::noArray());
  cv::calcOpticalFlowPyrLK(after, before, moved, back, found_back, cv::noArray());
  for (std::size_t i = 0; i < corners.size(); ++i)
    tracks.num_kept += found[i] && found_back[i] && cv::norm(back[i] - corners[i]) < 1;
  return tracks;
}

}  // namespace parkade::simulator

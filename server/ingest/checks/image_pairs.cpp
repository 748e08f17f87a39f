#include "server/ingest/checks/image_pairs.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/math/statistics.h"
#include "server/ingest/checks/image_noise.h"

namespace parkade {
namespace {

constexpr double kMaxStep = 0.5;       // [s] between the two images
constexpr std::size_t kMaxPairs = 40;  // more are thinned out
constexpr int kMaxCorners = 80;
constexpr double kMaxReturn = 0.7;  // [px] by which tracking there and back may miss

ImagePair Track(const RigCamera& camera, Timestamp first, const cv::Mat& from, Timestamp second,
                const cv::Mat& to) {
  ImagePair pair;
  pair.first = first;
  pair.second = second;
  pair.noise = ImageNoise(from);
  std::vector<cv::Point2f> corners, tracked, returned;
  cv::goodFeaturesToTrack(from, corners, kMaxCorners, 0.02, from.cols / 24.0, camera.mask);
  pair.num_corners = corners.size();
  if (corners.empty()) return pair;
  std::vector<unsigned char> is_found, is_back;
  std::vector<float> errors;
  const cv::Size window(15, 15);
  constexpr int kLevels = 4;
  cv::calcOpticalFlowPyrLK(from, to, corners, tracked, is_found, errors, window, kLevels);
  cv::calcOpticalFlowPyrLK(to, from, tracked, returned, is_back, errors, window, kLevels);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!is_found[i] || !is_back[i] || cv::norm(returned[i] - corners[i]) > kMaxReturn) continue;
    pair.from.emplace_back(corners[i].x, corners[i].y);
    pair.to.emplace_back(tracked[i].x, tracked[i].y);
  }
  return pair;
}

}  // namespace

bool ImagePair::IsStill() const {
  constexpr double kStill = 0.1;  // [px]
  double num_still = 0;
  for (std::size_t i = 0; i < from.size(); ++i)
    num_still += (to[i] - from[i]).norm() < kStill ? 1 : 0;
  return num_still > 0.95 * static_cast<double>(from.size());
}

double ImagePair::MedianMotion() const {
  constexpr std::size_t kFew = 10;
  if (from.size() < kFew) return 0;
  std::vector<double> motions;
  motions.reserve(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) motions.push_back((to[i] - from[i]).norm());
  return Median(std::move(motions));
}

bool ImagePairs::Wants(Timestamp time) const { return first_ || !next_ || time >= *next_; }

void ImagePairs::Include(Timestamp time, const cv::Mat& image) {
  if (first_ && time > *first_ && time - *first_ < kMaxStep) {
    pairs_.push_back(Track(*camera_, *first_, first_image_, time, image));
    first_.reset();
    first_image_.release();
    next_ = time + interval_;
    if (pairs_.size() > kMaxPairs) Thin();
    return;
  }
  first_ = time;
  first_image_ = image.clone();
}

double ImagePairs::Noise() const {
  if (pairs_.empty()) return 0;
  std::vector<double> noises;
  noises.reserve(pairs_.size());
  for (const ImagePair& pair : pairs_) noises.push_back(pair.noise);
  return Median(std::move(noises));
}

void ImagePairs::Thin() {
  for (std::size_t i = 0; 2 * i < pairs_.size(); ++i) pairs_[i] = std::move(pairs_[2 * i]);
  pairs_.resize((pairs_.size() + 1) / 2);
  interval_ *= 2;
}

}  // namespace parkade

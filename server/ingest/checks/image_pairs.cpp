#include "server/ingest/checks/image_pairs.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>

#include "core/math/statistics.h"
#include "core/parallel.h"
#include "server/ingest/checks/image_noise.h"

namespace parkade {
namespace {

constexpr double kMaxStep = 0.5;       // [s] between the two images
constexpr std::size_t kMaxPairs = 40;  // more are thinned out
constexpr int kMaxCorners = 80;
constexpr double kMaxReturn = 0.7;  // [px] by which tracking there and back may miss

void FollowPoints(const RigCamera& camera, const cv::Mat& from, const cv::Mat& to,
                  ImagePair& pair) {
  pair.noise = ImageNoise(from);
  std::vector<cv::Point2f> corners, tracked, returned;
  cv::goodFeaturesToTrack(from, corners, kMaxCorners, 0.02, from.cols / 24.0, camera.mask);
  pair.num_corners = corners.size();
  if (corners.empty()) return;
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

void ImagePairs::Include(Timestamp time, UndecodedImage image) {
  if (!first_ || time <= *first_ || time - *first_ >= kMaxStep) {
    first_ = time;
    first_image_ = std::move(image);
    return;
  }
  ImagePair& pair = pairs_.emplace_back();
  pair.first = *std::exchange(first_, std::nullopt);
  pair.second = time;
  waiting_.emplace_back(Waiting{std::exchange(first_image_, {}), std::move(image)});
  num_waiting_bytes_ += waiting_.back()->num_bytes();
  next_ = time + interval_;
  if (pairs_.size() > kMaxPairs) Thin();
}

void ImagePairs::Follow() {
  std::vector<char> is_lost(pairs_.size(), false);
  ParallelFor(pairs_.size(), [&](std::size_t i) {
    if (!waiting_[i]) return;
    const Waiting images = *std::exchange(waiting_[i], std::nullopt);
    const cv::Mat from = images.from.decode(), to = images.to.decode();
    is_lost[i] = from.empty() || to.empty();
    if (!is_lost[i]) FollowPoints(*camera_, from, to, pairs_[i]);
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    if (!is_lost[i] && count++ != i) pairs_[count - 1] = std::move(pairs_[i]);
  pairs_.resize(count);
  waiting_.assign(count, std::nullopt);
  num_waiting_bytes_ = 0;
}

double ImagePairs::Noise() const {
  if (pairs_.empty()) return 0;
  std::vector<double> noises;
  noises.reserve(pairs_.size());
  for (const ImagePair& pair : pairs_) noises.push_back(pair.noise);
  return Median(std::move(noises));
}

void ImagePairs::Thin() {
  const std::size_t count = (pairs_.size() + 1) / 2;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (i % 2 == 1 && waiting_[i]) num_waiting_bytes_ -= waiting_[i]->num_bytes();
    if (i % 2 == 1 || i == 0) continue;
    pairs_[i / 2] = std::move(pairs_[i]);
    waiting_[i / 2] = std::move(waiting_[i]);
  }
  pairs_.resize(count);
  waiting_.resize(count);
  interval_ *= 2;
}

}  // namespace parkade

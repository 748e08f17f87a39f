#include "slam/tracking/corner_scores.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/math/vectorized.h"

namespace parkade {

/// Works on the rows of an image, in integers.
namespace corner_scores {

constexpr int kWindow = 4;         ///< [blocks] edge of the window of the structure tensor
constexpr float kScharrGain = 32;  ///< derivative of a ramp of 1 gray level per px

/// Sums of the products of derivatives, one per column of pixels or blocks.
struct TensorRow {
  explicit TensorRow(size_t size = 0) : xx(size), xy(size), yy(size) {}

  std::vector<std::int32_t> xx, xy, yy;
};

/// The parts of Scharr's derivatives across three rows: mean times 16 and change.
PARKADE_VECTORIZED void DifferentiateAcross(const std::uint8_t* __restrict row, std::ptrdiff_t step,
                                            size_t size, std::int16_t* __restrict smooth,
                                            std::int16_t* __restrict change) {
  const std::uint8_t *above = row - step, *below = row + step;
  for (size_t x = 0; x < size; ++x) {
    smooth[x] = static_cast<std::int16_t>(3 * (above[x] + below[x]) + 10 * row[x]);
    change[x] = static_cast<std::int16_t>(below[x] - above[x]);
  }
}

PARKADE_VECTORIZED void AddProducts(const std::int16_t* __restrict smooth,
                                    const std::int16_t* __restrict change, size_t size,
                                    std::int32_t* __restrict xx, std::int32_t* __restrict xy,
                                    std::int32_t* __restrict yy) {
  for (size_t x = 0; x < size; ++x) {
    const auto dx = static_cast<std::int16_t>(smooth[x + 2] - smooth[x]);
    const auto dy = static_cast<std::int16_t>(3 * (change[x] + change[x + 2]) + 10 * change[x + 1]);
    xx[x] += dx * dx;
    xy[x] += dx * dy;
    yy[x] += dy * dy;
  }
}

/// Puts `next` into the sums in place of `last`, which becomes `next`.
PARKADE_VECTORIZED void Exchange(const std::int32_t* __restrict next, size_t size,
                                 std::int32_t* __restrict last, std::int32_t* __restrict sums) {
  for (size_t x = 0; x < size; ++x) {
    sums[x] += next[x] - last[x];
    last[x] = next[x];
  }
}

/// Sums of kWindow blocks from each on.
PARKADE_VECTORIZED void SumWindows(const std::int32_t* __restrict columns, size_t num_windows,
                                   std::int32_t* __restrict sums) {
  static_assert(kWindow * kCornerBlock == 8);
  for (size_t i = 0; i < num_windows; ++i) {
    const std::int32_t* at = columns + kCornerBlock * i;
    sums[i] = at[0] + at[1] + at[2] + at[3] + at[4] + at[5] + at[6] + at[7];
  }
}

/// Structure tensors over windows of an image, from the top down.
class TensorWindows {
 public:
  explicit TensorWindows(const cv::Mat& image)
      : image_(image),
        width_(static_cast<size_t>(image.cols)),
        smooth_(width_ + 2),
        change_(width_ + 2),
        next_(width_),
        sums_(width_),
        windows_(static_cast<size_t>(image.cols / kCornerBlock - kWindow + 1)) {
    ring_.fill(TensorRow(width_));
  }

  /// Moves the windows down to end with this row of blocks.
  void Add(int block_row) {
    next_ = TensorRow(width_);
    for (int y = block_row * kCornerBlock; y < (block_row + 1) * kCornerBlock; ++y) {
      const std::uint8_t* row = image_.ptr<std::uint8_t>(y) - 1;
      DifferentiateAcross(row, static_cast<std::ptrdiff_t>(image_.step[0]), width_ + 2,
                          smooth_.data(), change_.data());
      AddProducts(smooth_.data(), change_.data(), width_, next_.xx.data(), next_.xy.data(),
                  next_.yy.data());
    }
    TensorRow& last = ring_[static_cast<size_t>(block_row % kWindow)];
    Exchange(next_.xx.data(), width_, last.xx.data(), sums_.xx.data());
    Exchange(next_.xy.data(), width_, last.xy.data(), sums_.xy.data());
    Exchange(next_.yy.data(), width_, last.yy.data(), sums_.yy.data());
  }

  /// Smaller eigenvalues of the means, one per window.
  void Score(float* scores) {
    constexpr float kShare =
        1.0f / (kScharrGain * kScharrGain * kCornerBlock * kCornerBlock * kWindow * kWindow);
    SumWindows(sums_.xx.data(), windows_.xx.size(), windows_.xx.data());
    SumWindows(sums_.xy.data(), windows_.xy.size(), windows_.xy.data());
    SumWindows(sums_.yy.data(), windows_.yy.size(), windows_.yy.data());
    const auto size = static_cast<Eigen::Index>(windows_.xx.size());
    const auto of = [size](const std::vector<std::int32_t>& sums) {
      return Eigen::Map<const Eigen::ArrayXi>(sums.data(), size).cast<float>();
    };
    Eigen::Map<Eigen::ArrayXf>(scores, size) =
        kShare *
        (0.5f * (of(windows_.xx) + of(windows_.yy)) -
         ((0.5f * (of(windows_.xx) - of(windows_.yy))).square() + of(windows_.xy).square()).sqrt());
  }

 private:
  const cv::Mat& image_;
  size_t width_ = 0;  ///< [px]
  std::vector<std::int16_t> smooth_, change_;
  TensorRow next_, sums_, windows_;
  std::array<TensorRow, kWindow> ring_;
};

/// FindPeaks in one row, which each pointer is at the beginning of. Comparisons round nothing.
PARKADE_VECTORIZED void MarkPeaks(const float* __restrict above, const float* __restrict row,
                                  const float* __restrict below, size_t size, float least,
                                  std::uint8_t* __restrict is_peak) {
  for (size_t x = 1; x + 1 < size; ++x) {
    const float score = row[x];
    const bool is_first =
        (score > above[x - 1]) & (score > above[x]) & (score > above[x + 1]) & (score > row[x - 1]);
    const bool is_no_lower = (score >= row[x + 1]) & (score >= below[x - 1]) & (score >= below[x]) &
                             (score >= below[x + 1]);
    is_peak[x] = static_cast<std::uint8_t>((score >= least) & is_first & is_no_lower);
  }
}

}  // namespace corner_scores

cv::Mat CornerScores(const cv::Mat& image) {
  using namespace corner_scores;
  const int rows = image.rows / kCornerBlock, columns = image.cols / kCornerBlock;
  cv::Mat scores = cv::Mat::zeros(rows, columns, CV_32FC1);
  if (columns < kWindow) return scores;
  TensorWindows windows(image);
  for (int y = 0; y < rows; ++y) {
    windows.Add(y);
    if (y + 1 >= kWindow) windows.Score(scores.ptr<float>(y - kWindow / 2 + 1) + kWindow / 2);
  }
  return scores;
}

cv::Mat FindPeaks(const cv::Mat& scores, float least) {
  cv::Mat is_peak = cv::Mat::zeros(scores.size(), CV_8UC1);
  for (int y = 1; y + 1 < scores.rows; ++y)
    corner_scores::MarkPeaks(scores.ptr<float>(y - 1), scores.ptr<float>(y),
                             scores.ptr<float>(y + 1), static_cast<size_t>(scores.cols), least,
                             is_peak.ptr<std::uint8_t>(y));
  return is_peak;
}

}  // namespace parkade

#include "mapping/markings/axis_aligned_lines.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/markings/refine_line.h"

namespace parkade {
namespace {

constexpr double kMinContrast = 0.06;  // against both sides, of their brightness
constexpr double kMaxGap = 0.6;        // [m] that a line may be interrupted
constexpr float kKnownShare = 0.4F;    // of a box that must be known
constexpr double kColumnStep = 1.6;    // [pixels] from row to row that links maxima,
constexpr double kColumnDrift = 0.05;  // and per row of a gap
constexpr double kMaxSlope = 0.09;     // of a line
constexpr double kMaxResidual = 1.6;   // [pixels] RMS of a line's maxima
constexpr double kBothSidesShare = 0.5;
constexpr double kMinDensity = 0.5;  // maxima per row

/// One maximum of the filter across.
struct Peak {
  int row = 0;
  double column = 0;
  float answer = 0;
  bool has_both_sides = false;
};

/// What a stripe filter answers at each pixel of a row.
struct RowAnswer {
  std::vector<float> value;
  std::vector<bool> has_both_sides;
};

/// Mean brightness of boxes around each pixel, and the known and the sure share of each box.
struct BoxMeans {
  cv::Mat mean, share, sure;  // CV_32FC1

  BoxMeans(const RotatedRaster& ground, int width, int height) {
    cv::Mat known;
    cv::multiply(ground.brightness(), ground.mask(), known);
    cv::boxFilter(known, mean, -1, {width, height}, {-1, -1}, true, cv::BORDER_CONSTANT);
    cv::boxFilter(ground.mask(), share, -1, {width, height}, {-1, -1}, true, cv::BORDER_CONSTANT);
    cv::boxFilter(ground.sure(), sure, -1, {width, height}, {-1, -1}, true, cv::BORDER_CONSTANT);
    mean /= cv::max(share, 1e-3);
  }
};

RowAnswer AnswerRow(const BoxMeans& boxes, int row, int side) {
  const int columns = boxes.mean.cols;
  RowAnswer answer{std::vector<float>(static_cast<std::size_t>(columns), -1.0F),
                   std::vector<bool>(static_cast<std::size_t>(columns), false)};
  const float* mean = boxes.mean.ptr<float>(row);
  const float* share = boxes.share.ptr<float>(row);
  const float* sure = boxes.sure.ptr<float>(row);
  for (int column = side; column < columns - side; ++column) {
    if (share[column] < kKnownShare) continue;
    const bool has_left = share[column - side] >= kKnownShare,
               has_right = share[column + side] >= kKnownShare;
    if (!has_left && !has_right) continue;
    const float left = mean[column - side], right = mean[column + side];
    const float beside = has_left && has_right ? std::max(left, right) : has_left ? left : right;
    answer.value[static_cast<std::size_t>(column)] =
        (mean[column] - beside) / (beside + RotatedRaster::kDark);
    answer.has_both_sides[static_cast<std::size_t>(column)] =
        sure[column - side] >= kKnownShare && sure[column + side] >= kKnownShare;
  }
  return answer;
}

std::vector<Peak> PeaksOf(const RowAnswer& answer, int row, float threshold) {
  std::vector<Peak> peaks;
  const std::vector<float>& value = answer.value;
  for (std::size_t i = 2; i + 2 < value.size(); ++i) {
    const float here = value[i], left = value[i - 1], right = value[i + 1];
    if (here <= threshold || here < left || here <= right || here <= value[i - 2] ||
        here <= value[i + 2])
      continue;
    const float curvature = left - 2 * here + right;
    const float shift =
        curvature < -1e-6F ? std::clamp(0.5F * (left - right) / curvature, -0.5F, 0.5F) : 0.0F;
    peaks.push_back(
        {row, static_cast<double>(i) + static_cast<double>(shift), here, answer.has_both_sides[i]});
  }
  return peaks;
}

/// Maxima of one line, from the top.
struct Chain {
  std::vector<Peak> peaks;
  double column = 0;  ///< smoothed
};

/// Links maxima from row to row; chains that a gap ends move to `done`.
class ChainLinker {
 public:
  explicit ChainLinker(int max_gap) : max_gap_(max_gap) {}

  void AddRow(int row, const std::vector<Peak>& peaks) {
    std::vector<bool> is_used(peaks.size());
    std::vector<Chain> active;
    for (Chain& chain : active_) {
      const int gap = row - chain.peaks.back().row;
      const double reach = kColumnStep + kColumnDrift * gap;
      std::optional<std::size_t> best;
      for (std::size_t i = 0; i < peaks.size(); ++i) {
        const double distance = std::abs(peaks[i].column - chain.column);
        if (is_used[i] || distance > reach) continue;
        if (!best || distance < std::abs(peaks[*best].column - chain.column)) best = i;
      }
      if (best) {
        is_used[*best] = true;
        chain.column += 0.3 * (peaks[*best].column - chain.column);
        chain.peaks.push_back(peaks[*best]);
      }
      if (best || gap <= max_gap_)
        active.push_back(std::move(chain));
      else
        done_.push_back(std::move(chain));
    }
    for (std::size_t i = 0; i < peaks.size(); ++i)
      if (!is_used[i]) active.push_back({{peaks[i]}, peaks[i].column});
    active_ = std::move(active);
  }

  std::vector<Chain> Finish() && {
    for (Chain& chain : active_) done_.push_back(std::move(chain));
    return std::move(done_);
  }

 private:
  int max_gap_;
  std::vector<Chain> active_, done_;
};

/// A straight line through a chain's maxima, strong ones counting more; nothing where they are
/// none.
std::optional<AxisAlignedLine> FitLine(const Chain& chain) {
  double sum = 0, sum_row = 0, sum_column = 0, sum_row2 = 0, sum_both = 0, sum_answer = 0,
         num_both_sides = 0;
  for (const Peak& peak : chain.peaks) {
    const double weight = static_cast<double>(peak.answer), row = peak.row;
    sum += weight, sum_row += weight * row, sum_column += weight * peak.column;
    sum_row2 += weight * row * row, sum_both += weight * row * peak.column;
    sum_answer += weight;
    num_both_sides += peak.has_both_sides;
  }
  const double count = static_cast<double>(chain.peaks.size());
  const double rows = chain.peaks.back().row - chain.peaks.front().row + 1;
  const double determinant = sum * sum_row2 - sum_row * sum_row;
  if (count < kMinDensity * rows || !(determinant > 0)) return {};
  AxisAlignedLine line;
  line.slope = (sum * sum_both - sum_row * sum_column) / determinant;
  line.column_at_zero = (sum_column - line.slope * sum_row) / sum;
  line.first_row = chain.peaks.front().row, line.last_row = chain.peaks.back().row;
  line.contrast = sum_answer / count;
  line.is_one_sided = num_both_sides < kBothSidesShare * count;
  double squares = 0;
  for (const Peak& peak : chain.peaks)
    squares += std::pow(peak.column - line.ColumnAt(peak.row), 2);
  if (std::abs(line.slope) > kMaxSlope || std::sqrt(squares / count) > kMaxResidual) return {};
  return line;
}

}  // namespace

std::vector<AxisAlignedLine> FindAxisAlignedLines(const RotatedRaster& ground,
                                                  const PaintLineOptions& options) {
  const auto pixels = [&](double length) {
    return static_cast<int>(std::lround(length / options.pixel_size));
  };
  const auto odd = [](int value) { return std::max(1, value | 1); };
  const BoxMeans boxes(ground, odd(pixels(options.stripe_width) - 1),
                       odd(pixels(options.filter_length)));
  const int side = std::max(2, pixels(1.5 * options.stripe_width));
  ChainLinker linker(pixels(kMaxGap));
  for (int row = 0; row < ground.mask().rows; ++row)
    linker.AddRow(row, PeaksOf(AnswerRow(boxes, row, side), row, static_cast<float>(kMinContrast)));
  std::vector<AxisAlignedLine> lines;
  for (const Chain& chain : std::move(linker).Finish()) {
    if (static_cast<double>(chain.peaks.size()) * options.pixel_size < kMinLineLength) continue;
    std::optional<AxisAlignedLine> line = FitLine(chain);
    if (!line) continue;
    RefineLine(ground, options, *line);
    if (line->last_row > line->first_row) lines.push_back(*line);
  }
  return lines;
}

}  // namespace parkade

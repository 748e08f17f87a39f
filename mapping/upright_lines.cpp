#include "mapping/upright_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/paint_lines.h"

namespace parkade {
namespace {

constexpr float kKnownShare = 0.4F;    // of a box that must be known
constexpr float kDarkness = 15;        // of 255: in the dark contrast is noise
constexpr double kColumnStep = 1.6;    // [pixels] from row to row that links maxima,
constexpr double kColumnDrift = 0.05;  // and per row of a gap
constexpr double kMaxSlope = 0.09;     // of a line
constexpr double kMaxResidual = 1.6;   // [pixels] RMS of a line's maxima
constexpr double kBothSidesShare = 0.5;
constexpr double kMinDensity = 0.5;  // maxima per row
constexpr double kBeyond = 0.35;     // [m] behind an end that must be known for it to be one of paint
constexpr double kEndBox = 0.1;      // [m] along which brightness is averaged at the ends
constexpr double kEndLevel = 0.45;   // of the line's contrast that is left at its ends

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

  BoxMeans(const TurnedGround& ground, int width, int height) {
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
    const bool has_left = share[column - side] >= kKnownShare, has_right = share[column + side] >= kKnownShare;
    if (!has_left && !has_right) continue;
    const float left = mean[column - side], right = mean[column + side];
    const float beside = has_left && has_right ? std::max(left, right) : has_left ? left : right;
    answer.value[static_cast<std::size_t>(column)] = (mean[column] - beside) / (beside + kDarkness);
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
    if (here <= threshold || here < left || here <= right || here <= value[i - 2] || here <= value[i + 2]) continue;
    const float curvature = left - 2 * here + right;
    const float shift = curvature < -1e-6F ? std::clamp(0.5F * (left - right) / curvature, -0.5F, 0.5F) : 0.0F;
    peaks.push_back({row, static_cast<double>(i) + static_cast<double>(shift), here, answer.has_both_sides[i]});
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

/// A straight line through a chain's maxima, strong ones counting more; nothing where they are none.
std::optional<UprightLine> FitLine(const Chain& chain) {
  double sum = 0, sum_row = 0, sum_column = 0, sum_row2 = 0, sum_both = 0, sum_answer = 0, num_both_sides = 0;
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
  UprightLine line;
  line.slope = (sum * sum_both - sum_row * sum_column) / determinant;
  line.column_at_zero = (sum_column - line.slope * sum_row) / sum;
  line.first_row = chain.peaks.front().row, line.last_row = chain.peaks.back().row;
  line.contrast = sum_answer / count;
  line.is_one_sided = num_both_sides < kBothSidesShare * count;
  double squares = 0;
  for (const Peak& peak : chain.peaks) squares += std::pow(peak.column - line.ColumnAt(peak.row), 2);
  if (std::abs(line.slope) > kMaxSlope || std::sqrt(squares / count) > kMaxResidual) return {};
  return line;
}

/// Brightness at a place, or nothing where it is not known.
std::optional<double> BrightnessAt(const TurnedGround& ground, double column, int row) {
  const int left = static_cast<int>(std::floor(column));
  if (row < 0 || left < 0 || row >= ground.mask().rows || left + 1 >= ground.mask().cols) return {};
  const float* known = ground.mask().ptr<float>(row);
  if (known[left] < 0.5F || known[left + 1] < 0.5F) return {};
  const float* value = ground.brightness().ptr<float>(row);
  const double share = column - left;
  return (1 - share) * static_cast<double>(value[left]) + share * static_cast<double>(value[left + 1]);
}

/// Means over the rows of a line's neighbourhood, to see where its paint is.
class LineProfile {
 public:
  LineProfile(const TurnedGround& ground, const UprightLine& line, const PaintLineOptions& options)
      : ground_(ground), line_(line), stripe_(options.stripe_width / options.pixel_size) {}

  /// Of the paint at a row against the brighter of its sides; nothing where not known.
  std::optional<double> ContrastAt(int row) const {
    const double middle = line_.ColumnAt(row);
    const std::optional<double> center = Mean(middle - 0.25 * stripe_, middle + 0.25 * stripe_, row);
    if (!center) return {};
    const std::optional<double> left = Mean(middle - 1.8 * stripe_, middle - 1.1 * stripe_, row);
    const std::optional<double> right = Mean(middle + 1.1 * stripe_, middle + 1.8 * stripe_, row);
    if (!left && !right) return {};
    const double beside = left && right ? std::max(*left, *right) : left ? *left : *right;
    return (*center - beside) / (beside + static_cast<double>(kDarkness));
  }

  /// Whether there is sure ground at a row.
  bool IsSureAt(int row) const {
    const int column = static_cast<int>(std::lround(line_.ColumnAt(row)));
    if (row < 0 || column < 0 || row >= ground_.sure().rows || column >= ground_.sure().cols) return false;
    return ground_.sure().at<float>(row, column) > 0.5F;
  }

  /// [pixels] of the paint: its area over its height, between the first and last row.
  double Width() const {
    const int reach = static_cast<int>(std::ceil(2.2 * stripe_));
    std::vector<double> sums(static_cast<std::size_t>(2 * reach + 1)), counts(sums.size());
    for (int row = static_cast<int>(line_.first_row); row <= line_.last_row; ++row)
      for (int i = -reach; i <= reach; ++i)
        if (const std::optional<double> value = BrightnessAt(ground_, line_.ColumnAt(row) + i, row)) {
          sums[static_cast<std::size_t>(i + reach)] += *value;
          counts[static_cast<std::size_t>(i + reach)] += 1;
        }
    double low = 1e9, high = 0, area = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (counts[i] == 0) return stripe_;
      sums[i] /= counts[i];
      low = std::min(low, sums[i]), high = std::max(high, sums[i]);
    }
    for (const double value : sums) area += std::max(0.0, value - low - 0.15 * (high - low));
    return high > low ? std::min(area / (0.85 * (high - low)), 2.0 * reach) : stripe_;
  }

 private:
  std::optional<double> Mean(double from, double to, int row) const {
    double sum = 0;
    int count = 0;
    for (double column = from; column <= to + 1e-6; column += 1, ++count) {
      const std::optional<double> value = BrightnessAt(ground_, column, row);
      if (!value) return {};
      sum += *value;
    }
    return sum / count;
  }

  const TurnedGround& ground_;
  const UprightLine& line_;
  double stripe_;  ///< [pixels]
};

/// Where paint ends when one goes from row `from` towards `to` and a little beyond: the last place at which `level` of
/// contrast is left. Sets whether ground without paint was seen behind it.
double FindEnd(const LineProfile& profile, int from, int to, double level, double pixel_size, bool& is_seen) {
  const int step = to > from ? 1 : -1, box = std::max(1, static_cast<int>(std::lround(kEndBox / pixel_size)));
  const int beyond = static_cast<int>(std::ceil(kBeyond / pixel_size));
  const int count = std::abs(to - from) + beyond + box;
  std::vector<std::optional<double>> contrasts;
  for (int i = 0; i < count; ++i) contrasts.push_back(profile.ContrastAt(from + step * i));
  const auto mean_at = [&](int i) -> std::optional<double> {
    double sum = 0;
    int known = 0;
    for (int k = std::max(0, i - box / 2); k <= std::min(count - 1, i + box / 2); ++k)
      if (contrasts[static_cast<std::size_t>(k)]) sum += *contrasts[static_cast<std::size_t>(k)], ++known;
    if (2 * known < box) return {};
    return sum / known;
  };
  double end = from;
  int last = 0;
  for (int i = 0; i < count; ++i) {
    const std::optional<double> here = mean_at(i);
    if (!here || *here < level) continue;
    const std::optional<double> next = mean_at(i + 1);
    const double share = next && *next < level ? (*here - level) / (*here - *next) : 0;
    end = from + step * (i + share);
    last = i;
  }
  int num_known = 0, num_asked = 0;
  for (int i = last + 1; i < std::min(count, last + 1 + beyond); ++i, ++num_asked)
    num_known += profile.IsSureAt(from + step * i);
  is_seen = num_asked >= beyond / 2 && num_known >= 0.8 * num_asked;
  return end;
}

void RefineEnds(const TurnedGround& ground, const PaintLineOptions& options, UprightLine& line) {
  const LineProfile profile(ground, line, options);
  std::vector<double> contrasts;
  const int first = static_cast<int>(line.first_row), last = static_cast<int>(line.last_row);
  for (int row = first; row <= last; ++row)
    if (const std::optional<double> contrast = profile.ContrastAt(row)) contrasts.push_back(*contrast);
  if (contrasts.empty()) return;
  const auto middle = contrasts.begin() + static_cast<std::ptrdiff_t>(contrasts.size() / 2);
  std::nth_element(contrasts.begin(), middle, contrasts.end());
  const double level = kEndLevel * *middle;
  const int center = (first + last) / 2;
  line.first_row = FindEnd(profile, center, first, level, options.pixel_size, line.is_first_seen);
  line.last_row = FindEnd(profile, center, last, level, options.pixel_size, line.is_last_seen);
  line.contrast = *middle;
  line.width = LineProfile(ground, line, options).Width();
}

}  // namespace

TurnedGround::TurnedGround(const cv::Mat& brightness, const cv::Mat& mask, double source_size, double direction,
                           double pixel_size)
    : pixel_size_(pixel_size) {
  // Unit vectors of the turned picture in the source's pixels (rows south): its rows run along the lines.
  const double scale = pixel_size / source_size;
  const Eigen::Vector2d down = scale * Eigen::Vector2d(std::cos(direction), -std::sin(direction));
  const Eigen::Vector2d right(down.y(), -down.x());
  const double width = brightness.cols, height = brightness.rows;
  const int columns = static_cast<int>((std::abs(right.x()) * width + std::abs(right.y()) * height) / (scale * scale));
  const int rows = static_cast<int>((std::abs(down.x()) * width + std::abs(down.y()) * height) / (scale * scale));
  const Eigen::Vector2d middle(0.5 * (width - 1), 0.5 * (height - 1));
  source_from_turned_ << right, down, middle - 0.5 * (columns - 1) * right - 0.5 * (rows - 1) * down;
  cv::Mat warp(2, 3, CV_64FC1), known;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) warp.at<double>(i, k) = source_from_turned_(i, k);
  const cv::Size size(columns, rows);
  cv::warpAffine(brightness, brightness_, warp, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  cv::warpAffine(mask, known, warp, size, cv::INTER_NEAREST | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT);
  mask_ = cv::Mat(known.size(), CV_32FC1), sure_ = cv::Mat(known.size(), CV_32FC1);
  for (int row = 0; row < known.rows; ++row)
    for (int column = 0; column < known.cols; ++column) {
      const std::uint8_t value = known.at<std::uint8_t>(row, column);
      mask_.at<float>(row, column) = value == 0 ? 0.0F : 1.0F;
      sure_.at<float>(row, column) = value == GroundTile::kSure ? 1.0F : 0.0F;
    }
}

Eigen::Vector2d TurnedGround::SourceOf(double column, double row) const {
  return source_from_turned_ * Eigen::Vector3d(column, row, 1);
}

std::vector<UprightLine> FindUprightLines(const TurnedGround& ground, const PaintLineOptions& options) {
  const auto pixels = [&](double length) { return static_cast<int>(std::lround(length / options.pixel_size)); };
  const auto odd = [](int value) { return std::max(1, value | 1); };
  const BoxMeans boxes(ground, odd(pixels(options.stripe_width) - 1), odd(pixels(options.filter_length)));
  const int side = std::max(2, pixels(1.5 * options.stripe_width));
  ChainLinker linker(pixels(options.max_gap));
  for (int row = 0; row < ground.mask().rows; ++row)
    linker.AddRow(row, PeaksOf(AnswerRow(boxes, row, side), row, static_cast<float>(options.min_contrast)));
  std::vector<UprightLine> lines;
  for (const Chain& chain : std::move(linker).Finish()) {
    if (static_cast<double>(chain.peaks.size()) * options.pixel_size < options.min_length) continue;
    std::optional<UprightLine> line = FitLine(chain);
    if (!line) continue;
    RefineEnds(ground, options, *line);
    if (line->last_row > line->first_row) lines.push_back(*line);
  }
  return lines;
}

}  // namespace parkade

#include "mapping/markings/refine_line.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kBeyond = 0.35;  // [m] behind an end that must be known for it to be one of paint
constexpr double kEndBox = 0.1;   // [m] along which brightness is averaged at the ends
constexpr double kEndLevel = 0.45;  // of the line's contrast that is left at its ends

/// Brightness at a place, or nothing where it is not known.
std::optional<double> BrightnessAt(const RotatedRaster& ground, double column, int row) {
  const int left = static_cast<int>(std::floor(column));
  if (row < 0 || left < 0 || row >= ground.mask().rows || left + 1 >= ground.mask().cols) return {};
  const float* known = ground.mask().ptr<float>(row);
  if (known[left] < 0.5F || known[left + 1] < 0.5F) return {};
  const float* value = ground.brightness().ptr<float>(row);
  const double share = column - left;
  return (1 - share) * static_cast<double>(value[left]) +
         share * static_cast<double>(value[left + 1]);
}

/// Means over the rows of a line's neighborhood, to see where its paint is.
class LineProfile {
 public:
  LineProfile(const RotatedRaster& ground, const AxisAlignedLine& line,
              const PaintLineOptions& options)
      : ground_(ground), line_(line), stripe_(options.stripe_width / options.pixel_size) {}

  /// The contrast of the paint at a row against the brighter of its sides; nothing where not known.
  std::optional<double> ContrastAt(int row) const {
    const double middle = line_.ColumnAt(row);
    const std::optional<double> center =
        Mean(middle - 0.25 * stripe_, middle + 0.25 * stripe_, row);
    if (!center) return {};
    const std::optional<double> left = Mean(middle - 1.8 * stripe_, middle - 1.1 * stripe_, row);
    const std::optional<double> right = Mean(middle + 1.1 * stripe_, middle + 1.8 * stripe_, row);
    if (!left && !right) return {};
    const double beside = left && right ? std::max(*left, *right) : left ? *left : *right;
    return (*center - beside) / (beside + static_cast<double>(RotatedRaster::kDark));
  }

  /// Whether there is sure ground at a row.
  bool IsSureAt(int row) const {
    const int column = static_cast<int>(std::lround(line_.ColumnAt(row)));
    if (row < 0 || column < 0 || row >= ground_.sure().rows || column >= ground_.sure().cols)
      return false;
    return ground_.sure().at<float>(row, column) > 0.5F;
  }

  /// [pixels] of the paint: its area over its height, between the first and last row.
  double Width() const {
    const int reach = static_cast<int>(std::ceil(2.2 * stripe_));
    std::vector<double> sums(static_cast<std::size_t>(2 * reach + 1)), counts(sums.size());
    for (int row = static_cast<int>(line_.first_row); row <= line_.last_row; ++row)
      for (int i = -reach; i <= reach; ++i)
        if (const std::optional<double> value =
                BrightnessAt(ground_, line_.ColumnAt(row) + i, row)) {
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

  const RotatedRaster& ground_;
  const AxisAlignedLine& line_;
  double stripe_;  ///< [pixels]
};

/// Where paint ends when one goes from row `from` toward `to` and a little beyond: the last place
/// at which `level` of contrast is left. Sets whether ground without paint was seen behind it.
double FindEnd(const LineProfile& profile, int from, int to, double level, double pixel_size,
               bool& is_seen) {
  const int step = to > from ? 1 : -1,
            box = std::max(1, static_cast<int>(std::lround(kEndBox / pixel_size)));
  const int beyond = static_cast<int>(std::ceil(kBeyond / pixel_size));
  const int count = std::abs(to - from) + beyond + box;
  std::vector<std::optional<double>> contrasts;
  for (int i = 0; i < count; ++i) contrasts.push_back(profile.ContrastAt(from + step * i));
  const auto mean_at = [&](int i) -> std::optional<double> {
    double sum = 0;
    int known = 0;
    for (int k = std::max(0, i - box / 2); k <= std::min(count - 1, i + box / 2); ++k)
      if (contrasts[static_cast<std::size_t>(k)])
        sum += *contrasts[static_cast<std::size_t>(k)], ++known;
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

}  // namespace

void RefineLine(const RotatedRaster& ground, const PaintLineOptions& options,
                AxisAlignedLine& line) {
  const LineProfile profile(ground, line, options);
  std::vector<double> contrasts;
  const int first = static_cast<int>(line.first_row), last = static_cast<int>(line.last_row);
  for (int row = first; row <= last; ++row)
    if (const std::optional<double> contrast = profile.ContrastAt(row))
      contrasts.push_back(*contrast);
  if (contrasts.empty()) return;
  const double median = Median(std::move(contrasts)), level = kEndLevel * median;
  const int center = (first + last) / 2;
  line.first_row = FindEnd(profile, center, first, level, options.pixel_size, line.is_first_seen);
  line.last_row = FindEnd(profile, center, last, level, options.pixel_size, line.is_last_seen);
  line.contrast = median;
  line.width = LineProfile(ground, line, options).Width();
}

}  // namespace parkade

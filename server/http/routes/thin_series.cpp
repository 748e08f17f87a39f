#include "server/http/routes/thin_series.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

TimeSeries FiniteOf(const TimeSeries& series) {
  TimeSeries finite;
  for (size_t i = 0; i < series.values.size(); ++i) {
    if (!std::isfinite(series.values[i])) continue;
    finite.times.push_back(series.times[i]);
    finite.values.push_back(series.values[i]);
  }
  return finite;
}

}  // namespace

TimeSeries ThinSeries(const TimeSeries& series, int max_points) {
  TimeSeries all = FiniteOf(series);
  if (all.values.size() <= static_cast<size_t>(max_points)) return all;
  const int num_bins = max_points / 2;
  const double begin = all.times.front(), width = (all.times.back() - begin) / num_bins;
  const auto bin_of = [&](size_t i) {
    return std::min(num_bins - 1, static_cast<int>((all.times[i] - begin) / width));
  };
  TimeSeries thin;
  const auto add = [&](size_t i) {
    thin.times.push_back(all.times[i]);
    thin.values.push_back(all.values[i]);
  };
  for (size_t first = 0, end = 0; first < all.values.size(); first = end) {
    size_t least = first, greatest = first;
    for (end = first; end < all.values.size() && bin_of(end) == bin_of(first); ++end) {
      if (all.values[end] < all.values[least]) least = end;
      if (all.values[end] > all.values[greatest]) greatest = end;
    }
    add(std::min(least, greatest));
    if (least != greatest) add(std::max(least, greatest));
  }
  return thin;
}

ThinnedRange ThinRange(const TimeSeries& series, double begin, double end, int max_points) {
  const auto& times = series.times;
  const auto first = std::lower_bound(times.begin(), times.end(), begin) - times.begin(),
             last = std::upper_bound(times.begin(), times.end(), end) - times.begin();
  const auto& values = series.values;
  ThinnedRange thin;
  thin.count = static_cast<size_t>(std::max<std::ptrdiff_t>(0, last - first));
  if (thin.count > 0)
    thin.series = ThinSeries({{times.begin() + first, times.begin() + last},
                              {values.begin() + first, values.begin() + last}},
                             max_points);
  if (first > 0) {
    thin.series.times.insert(thin.series.times.begin(), times[static_cast<size_t>(first) - 1]);
    thin.series.values.insert(thin.series.values.begin(), values[static_cast<size_t>(first) - 1]);
  }
  if (static_cast<size_t>(last) < times.size()) {
    thin.series.times.push_back(times[static_cast<size_t>(last)]);
    thin.series.values.push_back(values[static_cast<size_t>(last)]);
  }
  return thin;
}

}  // namespace parkade

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

}  // namespace parkade

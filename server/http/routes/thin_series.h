#pragma once

#include <cstddef>
#include <vector>

namespace parkade {

/// Samples of one quantity over time.
struct TimeSeries {
  std::vector<double> times;   ///< increasing
  std::vector<double> values;  ///< one per time
};

/// At most `max_points` (2 or more) of the samples of a series, so that its plot keeps its shape:
/// of each of max_points / 2 equal stretches of time the samples with the least and the greatest
/// value, in order of time. A series that is short enough stays as it is. Values that are not
/// finite are left out.
TimeSeries ThinSeries(const TimeSeries& series, int max_points);

struct ThinnedRange {
  TimeSeries series;
  std::size_t count = 0;  ///< of the samples within the range, before they were thinned
};

/// The samples of a series between two times, thinned to `max_points` by themselves, and the next
/// ones on either side, so that a line runs to the edges of its plot.
ThinnedRange ThinRange(const TimeSeries& series, double begin, double end, int max_points);

}  // namespace parkade

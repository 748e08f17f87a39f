#pragma once

#include <string>
#include <vector>

#include "tests/bench/odometry/odometry_table.h"

namespace parkade {

/// The table of goals, filled: a row per variant and kind of place, then four cameras
/// against the best single one, then every drive. Markdown.
std::string ToMarkdown(const std::vector<TableRun>& runs);

/// Mean, median, worst; the median of an even number is the mean of the middle two.
struct Spread {
  double mean = 0, median = 0, worst = 0;
};
Spread SpreadOf(std::vector<double> values);

}  // namespace parkade

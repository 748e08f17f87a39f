// What the runs of a place say, and how it is shown.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "tests/bench/odometry/odometry_places.h"
#include "tests/simulator/common/random.h"

namespace parkade {
namespace {

constexpr int kResamples = 2000;
constexpr double kNear = 1.05;  // of the luckiest camera's drift

std::vector<double> RootMeanSquares(const std::vector<const std::vector<double>*>& rows) {
  std::vector<double> rms(rows.front()->size(), 0);
  for (const std::vector<double>* row : rows)
    for (size_t i = 0; i < rms.size(); ++i)
      rms[i] += row->at(i) * row->at(i) / static_cast<double>(rows.size());
  for (double& value : rms) value = std::sqrt(value);
  return rms;
}

size_t BestSingle(const std::vector<double>& rms) {
  return static_cast<size_t>(std::min_element(rms.begin() + 1, rms.end()) - rms.begin());
}

double RatioToBest(const std::vector<double>& rms) { return rms.front() / rms[BestSingle(rms)]; }

/// 2.5 % and 97.5 % of the ratio, runs drawn with repetition (B. Efron, "Bootstrap methods: another
/// look at the jackknife", 1979).
void Resample(const std::vector<const std::vector<double>*>& rows, PlaceSummary& summary) {
  simulator::Random random(rows.size(), 0xb007);
  std::vector<double> ratios;
  for (int k = 0; k < kResamples; ++k) {
    std::vector<const std::vector<double>*> drawn;
    for (size_t i = 0; i < rows.size(); ++i)
      drawn.push_back(rows[static_cast<size_t>(random.Index(static_cast<int>(rows.size())))]);
    ratios.push_back(RatioToBest(RootMeanSquares(drawn)));
  }
  std::sort(ratios.begin(), ratios.end());
  summary.low = ratios[kResamples / 40];
  summary.high = ratios[kResamples - 1 - kResamples / 40];
}

/// Correlation by the errors' inner products, summed over the runs; 0 where no run has them.
double WantedShare(const std::vector<PlaceRun>& runs, size_t of, size_t num_estimates) {
  double gain = 0, squared_difference = 0;
  for (const PlaceRun& run : runs) {
    if (run.error_products.size() != num_estimates * num_estimates) continue;
    const double all = run.error_products[0], both = run.error_products[of];
    gain += all - both;
    squared_difference += all - 2 * both + run.error_products[of * num_estimates + of];
  }
  return squared_difference > 0 ? gain / squared_difference : 0;
}

std::string TableRow(const PlaceRun& first, const PlaceSummary& summary) {
  char text[80];
  std::string row = "| " + first.place + " | " + first.rig + " | " + first.estimator + " | " +
                    std::to_string(summary.num_runs);
  for (const double drift : summary.rms_drift) {
    std::snprintf(text, sizeof text, " | %.3f", drift);
    row += text;
  }
  std::snprintf(text, sizeof text, " | %.2f [%.2f, %.2f] | %.0f %% | %.2f |", summary.ratio,
                summary.low, summary.high, 100 * summary.near_luckiest, summary.wanted_share);
  row += text;
  for (const double scale : summary.rms_scale) {
    std::snprintf(text, sizeof text, " %.2f", scale);
    row += text;
  }
  return row + " |\n";
}

}  // namespace

PlaceSummary SummarizePlace(const std::vector<PlaceRun>& runs) {
  Require(!runs.empty() && runs.front().drift_percent.size() > 1, ErrorCode::kUsage,
          "a place needs runs of two estimates at least");
  std::vector<const std::vector<double>*> drifts, scales;
  PlaceSummary summary;
  for (const PlaceRun& run : runs) {
    Require(run.drift_percent.size() == runs.front().drift_percent.size(), ErrorCode::kUsage,
            "runs of one place must have as many cameras each");
    drifts.push_back(&run.drift_percent);
    scales.push_back(&run.scale_percent);
    const double luckiest =
        *std::min_element(run.drift_percent.begin() + 1, run.drift_percent.end());
    summary.near_luckiest +=
        (run.drift_percent.front() <= kNear * luckiest) / static_cast<double>(runs.size());
  }
  summary.num_runs = runs.size();
  summary.rms_drift = RootMeanSquares(drifts);
  summary.rms_scale = RootMeanSquares(scales);
  summary.best = BestSingle(summary.rms_drift);
  summary.ratio = RatioToBest(summary.rms_drift);
  summary.wanted_share = WantedShare(runs, summary.best, summary.rms_drift.size());
  Resample(drifts, summary);
  return summary;
}

std::string PlaceTable(const std::vector<PlaceRun>& runs) {
  std::vector<std::vector<PlaceRun>> groups;
  for (const PlaceRun& run : runs) {
    const auto group =
        std::find_if(groups.begin(), groups.end(), [&](const std::vector<PlaceRun>& known) {
          return known.front().place == run.place && known.front().rig == run.rig &&
                 known.front().estimator == run.estimator;
        });
    if (group != groups.end())
      group->push_back(run);
    else
      groups.push_back({run});
  }
  if (groups.empty()) return {};
  std::string head = "| place | rig off by | estimator | runs | all", rule = "|---|---|---|---|---";
  for (size_t camera = 1; camera < groups.front().front().drift_percent.size(); ++camera) {
    head += " | cam" + std::to_string(camera - 1);
    rule += "|---";
  }
  std::string table = head + " | all / best | near the luckiest | wanted | scale |\n" + rule +
                      "|---|---|---|---|\n";
  for (const std::vector<PlaceRun>& group : groups)
    table += TableRow(group.front(), SummarizePlace(group));
  return table;
}

}  // namespace parkade

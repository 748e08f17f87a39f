// Tables and images of LoopRuns.
#include <algorithm>
#include <cstdio>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "core/math/statistics.h"
#include "tests/bench/loops/loop_table.h"

namespace parkade {
namespace {

constexpr double kMuchWorse = 1.05;  // than odometry

template <typename... Values>
std::string Print(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::vector<double> ErrorsOf(const LoopRun& run, double scale, double LoopError::*what) {
  std::vector<double> errors;
  for (const LoopError& error : run.accepted) errors.push_back(scale * error.*what);
  return errors;
}

std::string RowOf(const LoopRun& run) {
  std::vector<double> inliers;
  for (const LoopError& error : run.accepted) inliers.push_back(error.num_inliers);
  const double decks =
      static_cast<double>(std::count_if(run.accepted.begin(), run.accepted.end(),
                                        [](const LoopError& e) { return std::abs(e.height) > 2; }));
  return Print(
      "| %s | %s | %.0f | %.3f | %.3f | %zu / %d | %.0f | %.3f | %.2f | %d | %.0f | %d / %d | %.1f "
      "|\n",
      run.drive.c_str(), run.method.c_str(), run.length, run.ate, run.drift_percent,
      run.accepted.size(), run.num_candidates, Median(inliers),
      Median(ErrorsOf(run, 1, &LoopError::translation)),
      Median(ErrorsOf(run, 180 / M_PI, &LoopError::rotation)), run.num_wrong, decks,
      run.num_opposite_found, run.num_opposite_chances, run.seconds);
}

/// How honest the loops' information is: 1 where errors are as large as claimed.
std::string HonestyOf(const std::vector<LoopRun>& runs) {
  std::map<std::string, std::vector<double>> squared;
  for (const LoopRun& run : runs)
    for (const LoopError& error : run.accepted) squared[run.method].push_back(error.squared);
  std::string text =
      "Squared errors of accepted loops, in units of what they claim, mean (median):";
  for (const auto& [method, values] : squared)
    text += Print(
        " %s %.2f (%.2f)", method.c_str(),
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()),
        Median(values));
  return text + ".\n";
}

/// Bars of `values` between 0 and `limit`; what is larger falls into the last.
void DrawHistogram(const std::vector<double>& values, double limit, const std::string& title,
                   cv::Mat image) {
  constexpr int kBars = 40;
  std::vector<int> counts(kBars);
  for (const double value : values)
    ++counts[static_cast<size_t>(std::min(kBars - 1, static_cast<int>(value / limit * kBars)))];
  const int most = std::max(1, *std::max_element(counts.begin(), counts.end()));
  const int bottom = image.rows - 24, height = image.rows - 60, width = (image.cols - 40) / kBars;
  for (int i = 0; i < kBars; ++i) {
    const int bar = counts[static_cast<size_t>(i)] * height / most;
    cv::rectangle(image, {20 + i * width, bottom - bar}, {20 + (i + 1) * width - 2, bottom},
                  i + 1 == kBars ? cv::Scalar(60, 60, 200) : cv::Scalar(160, 110, 60), cv::FILLED);
  }
  cv::line(image, {20, bottom}, {20 + kBars * width, bottom}, {0, 0, 0});
  const auto text = [&](const std::string& what, cv::Point at) {
    cv::putText(image, what, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, {0, 0, 0}, 1, cv::LINE_AA);
  };
  text(title, {20, 18});
  text("0", {16, image.rows - 8});
  text(Print("%g+", limit), {kBars * width - 20, image.rows - 8});
}

}  // namespace

std::string ToMarkdown(const std::vector<LoopRun>& runs) {
  std::string text =
      "| drive | loops | length, m | ATE, m | drift, % | accepted / candidates | inliers | "
      "translation error, m | "
      "rotation "
      "error, deg | wrong | between decks | opposite | s "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::map<std::string, std::map<std::string, double>> ates;  // by drive, by method
  std::map<std::string, bool> has_loops;
  for (const LoopRun& run : runs) {
    text += RowOf(run);
    ates[run.drive][run.method] = run.ate;
    has_loops[run.drive] = has_loops[run.drive] || (run.method == "rig" && !run.accepted.empty());
  }
  int num_drives = 0;
  std::map<std::string, int> best, worse;
  for (const auto& [drive, of_drive] : ates) {
    if (!has_loops[drive] || !of_drive.contains("none")) continue;
    ++num_drives;
    std::string winner = "none";
    for (const auto& [method, ate] : of_drive) {
      if (!method.ends_with("+refine") && ate < of_drive.at(winner)) winner = method;
      worse[method] += ate > kMuchWorse * of_drive.at("none");
    }
    ++best[winner];
  }
  text += Print("\nDrives with revisits: %d. Best of the ways to measure loops:", num_drives);
  for (const auto& [method, count] : best) text += Print(" %s %d", method.c_str(), count);
  text += ". Worse than odometry by more than 5 %:";
  for (const auto& [method, count] : worse)
    if (count > 0) text += Print(" %s %d", method.c_str(), count);
  return text + ".\n" + HonestyOf(runs);
}

cv::Mat PlotLoopErrors(const std::vector<LoopRun>& runs) {
  const std::vector<std::string> methods = {"pnp", "scale-less", "rotation-only", "rig"};
  cv::Mat image(200 * static_cast<int>(methods.size()), 1000, CV_8UC3, cv::Scalar(255, 255, 255));
  for (size_t i = 0; i < methods.size(); ++i) {
    std::vector<double> translations, rotations;
    for (const LoopRun& run : runs) {
      if (run.method != methods[i]) continue;
      const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin(), from.end());
      };
      add(translations, ErrorsOf(run, 1, &LoopError::translation));
      add(rotations, ErrorsOf(run, 180 / M_PI, &LoopError::rotation));
    }
    const int top = static_cast<int>(i) * 200;
    DrawHistogram(translations, 0.4,
                  methods[i] + Print(": translation error, m (%zu loops, median %.3f)",
                                     translations.size(), Median(translations)),
                  image({0, top, 500, 200}));
    DrawHistogram(rotations, 1.0,
                  methods[i] + Print(": rotation error, degrees (median %.2f)", Median(rotations)),
                  image({500, top, 500, 200}));
  }
  return image;
}

}  // namespace parkade

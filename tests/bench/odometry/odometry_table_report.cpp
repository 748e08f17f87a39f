#include "tests/bench/odometry/odometry_table_report.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace parkade {
namespace {

using Runs = std::vector<TableRun>;

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string Format(const char* format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

bool IsGarage(const TableRun& run) { return run.scene == "garage"; }

Spread Of(const Runs& runs, const std::function<double(const TableRun&)>& value) {
  std::vector<double> values;
  for (const TableRun& run : runs)
    if (run.error.empty()) values.push_back(value(run));
  return SpreadOf(values);
}

std::string Row(const std::string& variant, const std::string& places, const Runs& runs) {
  const auto failures = std::count_if(runs.begin(), runs.end(), IsFailure);
  const Spread drift = Of(runs, [](const TableRun& run) { return run.drift_percent; });
  const Spread ate = Of(runs, [](const TableRun& run) { return run.ate; });
  const Spread rotation = Of(runs, [](const TableRun& run) { return run.rotation_deg; });
  const Spread translation = Of(runs, [](const TableRun& run) { return run.translation_mm; });
  const Spread stamps = Of(runs, [](const TableRun& run) { return run.time_offset_ms; });
  const Spread uncovered = Of(runs, [](const TableRun& run) { return 100 * (1 - run.coverage); });
  const Spread speed =
      Of(runs, [](const TableRun& run) { return run.wall_seconds / run.duration; });
  const Spread memory = Of(runs, [](const TableRun& run) { return run.peak_memory_mb; });
  return Format(
      "| %s | %s | %zu | %.3f / %.3f / %.3f | %.3f / %.3f | %.1f | %td | %.3f / %.3f | %.1f / %.1f "
      "| %.2f / %.2f | "
      "%.2f | "
      "%.0f |\n",
      variant.c_str(), places.c_str(), runs.size(), drift.mean, drift.median, drift.worst, ate.mean,
      ate.worst, 100 - uncovered.worst, failures, rotation.mean, rotation.worst, translation.mean,
      translation.worst, stamps.mean, stamps.worst, speed.mean, memory.worst);
}

/// Variants in the order in which they come up.
std::vector<std::string> VariantsOf(const Runs& runs) {
  std::vector<std::string> names;
  for (const TableRun& run : runs)
    if (std::find(names.begin(), names.end(), run.variant) == names.end())
      names.push_back(run.variant);
  return names;
}

Runs Select(const Runs& runs, const std::function<bool(const TableRun&)>& is_wanted) {
  Runs selected;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(selected), is_wanted);
  return selected;
}

std::string SummaryTable(const Runs& runs) {
  std::string text =
      "| variant | places | drives | drift %: mean / median / worst | ATE m: mean / worst | "
      "covered %, least | "
      "failures | "
      "rotations off deg: mean / worst | places off mm: mean / worst | stamps off ms: mean / worst "
      "| time / real time "
      "| "
      "memory MB |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const std::string& variant : VariantsOf(runs))
    for (const bool is_garage : {false, true}) {
      const Runs some = Select(runs, [&](const TableRun& run) {
        return run.variant == variant && IsGarage(run) == is_garage;
      });
      if (!some.empty()) text += Row(variant, is_garage ? "garages" : "lots, streets", some);
    }
  return text;
}

/// How many times the drift of the best single camera, per drive.
std::string AgainstSingleCameras(const Runs& runs) {
  std::map<std::string, std::map<std::string, double>> four, best;  // rig -> drive -> drift
  for (const TableRun& run : runs) {
    const TableVariant variant = ParseVariant(run.variant);
    if (variant.has_wheels) continue;
    const double drift = run.error.empty() ? run.drift_percent : 100;
    if (variant.camera.empty()) {
      four[variant.rig][run.drive] = drift;
    } else {
      const auto [at, is_new] = best[variant.rig].emplace(run.drive, drift);
      at->second = std::min(at->second, drift);
    }
  }
  std::string text =
      "| rig | drives | four / best single camera: mean / median / worst | worse by more than 5 % "
      "|\n"
      "|---|---|---|---|\n";
  for (const auto& [rig, singles] : best) {
    std::vector<double> ratios;
    std::string worse;
    for (const auto& [drive, drift] : singles) {
      const auto with_four = four[rig].find(drive);
      if (with_four == four[rig].end()) continue;
      ratios.push_back(with_four->second / drift);
      if (ratios.back() > 1.05)
        worse += Format(" %s %.3f/%.3f", drive.c_str(), with_four->second, drift);
    }
    const Spread spread = SpreadOf(ratios);
    text += Format("| %s | %zu | %.2f / %.2f / %.2f |%s |\n", rig.c_str(), ratios.size(),
                   spread.mean, spread.median, spread.worst, worse.c_str());
  }
  return text;
}

std::string DriveTable(const Runs& runs) {
  const std::vector<std::string> variants = VariantsOf(runs);
  std::set<std::string> drives;
  std::map<std::string, std::map<std::string, std::string>> cells;
  std::map<std::string, double> lengths;
  for (const TableRun& run : runs) {
    drives.insert(run.drive);
    cells[run.drive][run.variant] = run.error.empty() ? Format("%.3f", run.drift_percent) : "none";
    lengths[run.drive] = std::max(lengths[run.drive], run.length);
  }
  std::string text = "| drift % | m |", line = "|---|---|";
  for (const std::string& variant : variants) {
    text += " " + variant + " |";
    line += "---|";
  }
  text += "\n" + line + "\n";
  for (const std::string& drive : drives) {
    text += "| " + drive + Format(" | %.0f |", lengths[drive]);
    for (const std::string& variant : variants) text += " " + cells[drive][variant] + " |";
    text += "\n";
  }
  return text;
}

}  // namespace

Spread SpreadOf(std::vector<double> values) {
  Spread spread;
  if (values.empty()) return spread;
  std::sort(values.begin(), values.end());
  for (const double value : values) spread.mean += value / static_cast<double>(values.size());
  spread.median = 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  spread.worst = values.back();
  return spread;
}

std::string ToMarkdown(const Runs& runs) {
  return SummaryTable(runs) + "\n" + AgainstSingleCameras(runs) + "\n" + DriveTable(runs);
}

nlohmann::json ToJson(const TableRun& run) {
  return {{"drive", run.drive},
          {"scene", run.scene},
          {"variant", run.variant},
          {"error", run.error},
          {"length_m", run.length},
          {"duration_s", run.duration},
          {"ate_m", run.ate},
          {"drift_percent", run.drift_percent},
          {"coverage", run.coverage},
          {"rotation_error_deg", run.rotation_deg},
          {"translation_error_mm", run.translation_mm},
          {"released_rotation_error_deg", run.released_deg},
          {"released_translation_error_mm", run.released_mm},
          {"num_released", run.num_released},
          {"time_offset_error_ms", run.time_offset_ms},
          {"wall_s", run.wall_seconds},
          {"peak_memory_mb", run.peak_memory_mb},
          {"start_s", run.start_seconds},
          {"start_kind", run.start_kind},
          {"noise_scales", run.noise_scales},
          {"degraded", run.degraded}};
}

TableRun TableRunFromJson(const nlohmann::json& json) {
  TableRun run;
  const auto get = [&](const char* key, auto& into) { json.at(key).get_to(into); };
  get("drive", run.drive);
  get("scene", run.scene);
  get("variant", run.variant);
  get("error", run.error);
  get("length_m", run.length);
  get("duration_s", run.duration);
  get("ate_m", run.ate);
  get("drift_percent", run.drift_percent);
  get("coverage", run.coverage);
  get("rotation_error_deg", run.rotation_deg);
  get("translation_error_mm", run.translation_mm);
  get("released_rotation_error_deg", run.released_deg);
  get("released_translation_error_mm", run.released_mm);
  get("num_released", run.num_released);
  get("time_offset_error_ms", run.time_offset_ms);
  get("wall_s", run.wall_seconds);
  get("peak_memory_mb", run.peak_memory_mb);
  get("start_s", run.start_seconds);
  get("start_kind", run.start_kind);
  get("noise_scales", run.noise_scales);
  get("degraded", run.degraded);
  return run;
}

}  // namespace parkade

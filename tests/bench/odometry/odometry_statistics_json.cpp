// JSON of the statistics: every run under its case.
#include <nlohmann/json.hpp>

#include "core/options_json.h"
#include "tests/bench/odometry/odometry_statistics.h"

namespace parkade {

nlohmann::json ToJson(const StatisticsRun& run) {
  nlohmann::json json = {{"seed", run.seed},
                         {"error", run.error},
                         {"start_kind", run.start_kind},
                         {"length_m", run.length},
                         {"duration_s", run.duration},
                         {"ate_m", run.ate},
                         {"drift_percent", run.drift_percent},
                         {"rotation_error_deg", run.rotation_error_deg},
                         {"translation_error_cm", run.translation_error_cm},
                         {"time_offset_error_ms", run.time_offset_error_ms},
                         {"wheel_scale_error", run.wheel_scale_error},
                         {"start_s", run.start_seconds},
                         {"coverage", run.coverage},
                         {"noise_scale", run.noise_scale},
                         {"making_s", run.making_seconds},
                         {"making_ms_per_image", run.making_ms_per_image},
                         {"estimating_s", run.estimating_seconds}};
  for (const PoseConsistency& at : run.consistency)
    json["nees"].push_back({{"time_s", at.time},
                            {"pose", at.pose},
                            {"rotation", at.rotation},
                            {"position", at.position},
                            {"rotation_error_rad", at.rotation_error},
                            {"position_error_m", at.position_error}});
  return json;
}

nlohmann::json ToJson(const StatisticsCase& question, const std::vector<StatisticsRun>& runs) {
  nlohmann::json json = {{"case", question.name},
                         {"start", question.start},
                         {"track_mode", OptionsToJson(question.drive)},
                         {"odometry", OptionsToJson(question.odometry)}};
  for (const StatisticsRun& run : runs) json["runs"].push_back(ToJson(run));
  return json;
}

}  // namespace parkade

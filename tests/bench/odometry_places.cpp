#include "tests/bench/odometry_places.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "slam/evaluate_trajectory.h"
#include "tests/bench/odometry_statistics.h"
#include "tests/simulator/random.h"

namespace parkade {
namespace {

using simulator::TrackDrive;

constexpr int kResamples = 2000;
constexpr double kNear = 1.05;  // of the luckiest camera's drift

void Estimate(const TrackDrive& drive, const OdometryOptions& odometry, PlaceRun& run) {
  double drift = kNoAnswer, scale = 0;
  try {
    const OdometryResult result = EstimateTrackDrive(drive, odometry);
    const TrajectoryEvaluation evaluation = EvaluateTrajectory(drive.truth, ToTimedPoses(result.odom_from_body));
    drift = std::min(kNoAnswer, 100 * evaluation.rigid.translation.rmse / std::max(1.0, drive.length));
    scale = 100 * (evaluation.scale - 1);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kUsage) throw;
  }
  run.drift_percent.push_back(drift);
  run.scale_percent.push_back(scale);
}

std::vector<double> RootMeanSquares(const std::vector<const std::vector<double>*>& rows) {
  std::vector<double> rms(rows.front()->size(), 0);
  for (const std::vector<double>* row : rows)
    for (size_t i = 0; i < rms.size(); ++i) rms[i] += row->at(i) * row->at(i) / static_cast<double>(rows.size());
  for (double& value : rms) value = std::sqrt(value);
  return rms;
}

size_t BestSingle(const std::vector<double>& rms) {
  return static_cast<size_t>(std::min_element(rms.begin() + 1, rms.end()) - rms.begin());
}

double RatioToBest(const std::vector<double>& rms) { return rms.front() / rms[BestSingle(rms)]; }

/// 2.5 % and 97.5 % of the ratio, runs drawn with repetition (B. Efron, "Bootstrap methods: another look at the
/// jackknife", 1979).
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

std::string TableRow(const PlaceRun& first, const PlaceSummary& summary) {
  char text[80];
  std::string row = "| " + first.place + " | " + first.rig + " | " + std::to_string(summary.num_runs);
  for (const double drift : summary.rms_drift) {
    std::snprintf(text, sizeof text, " | %.3f", drift);
    row += text;
  }
  std::snprintf(text, sizeof text, " | %.2f [%.2f, %.2f] | %.0f %% |", summary.ratio, summary.low, summary.high,
                100 * summary.near_luckiest);
  row += text;
  for (const double scale : summary.rms_scale) {
    std::snprintf(text, sizeof text, " %.2f", scale);
    row += text;
  }
  return row + " |\n";
}

}  // namespace

PlaceCase ParsePlace(const std::string& name, double duration) {
  const size_t first = name.find(':'), second = name.find(':', first + 1);
  const std::string seed = first == std::string::npos ? "" : name.substr(first + 1, second - first - 1);
  Require(!seed.empty() && seed.size() < 9 && seed.find_first_not_of("0123456789") == std::string::npos,
          ErrorCode::kUsage, "'" + name + "' is no place: SCENE:SEED[:START]");
  PlaceCase place;
  place.name = name;
  if (second != std::string::npos) place.start = name.substr(second + 1);
  Require(place.start == "standing" || place.start == "rolling" || place.start == "turning", ErrorCode::kUsage,
          "'" + name + "' must start standing, rolling or turning");
  simulator::SimulateOptions& drive = place.drive.drive;
  drive.scene = name.substr(0, first);
  drive.seed = std::stoi(seed);
  drive.duration = duration;
  drive.sensors.has_wheels = false;
  drive.sensors.gnss = "none";
  return place;
}

void SetRigError(const std::string& rig, simulator::TrackDriveOptions& drive) {
  if (rig == "exact") return;
  Require(rig == "0.3" || rig == "1", ErrorCode::kUsage, "'" + rig + "' is no rig: exact, 0.3 or 1");
  drive.drive.faults.extrinsic_rotation_deg = {std::stod(rig)};
  drive.drive.faults.extrinsic_translation_cm = {rig == "1" ? 3.0 : 1.0};
}

TrackDrive OneCamera(const TrackDrive& drive, size_t camera) {
  TrackDrive one = drive;
  one.rig.cameras = {drive.rig.cameras.at(camera)};
  one.true_rig.cameras = {drive.true_rig.cameras.at(camera)};
  std::erase_if(one.pictures, [&](const simulator::SeenPicture& picture) {
    return picture.frame.camera != static_cast<int>(camera);
  });
  for (simulator::SeenPicture& picture : one.pictures) {
    picture.frame.camera = 0;
    picture.crossed.clear();
    picture.pair_seconds = 0;
  }
  return one;
}

PlaceRun RunPlace(const PlaceCase& place, const std::string& rig, int noise_seed, const OdometryOptions& odometry) {
  simulator::TrackDriveOptions asked = place.drive;
  SetRigError(rig, asked);
  asked.noise_seed = noise_seed;
  if (place.start != "standing") asked.begin = simulator::FindMovingStart(asked, place.start == "turning");
  const TrackDrive drive = simulator::MakeTrackDrive(asked, odometry);
  PlaceRun run{place.name, rig, noise_seed, drive.length, {}, {}};
  Estimate(drive, odometry, run);
  for (size_t camera = 0; camera < drive.rig.cameras.size(); ++camera)
    Estimate(OneCamera(drive, camera), odometry, run);
  return run;
}

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
    const double luckiest = *std::min_element(run.drift_percent.begin() + 1, run.drift_percent.end());
    summary.near_luckiest += (run.drift_percent.front() <= kNear * luckiest) / static_cast<double>(runs.size());
  }
  summary.num_runs = runs.size();
  summary.rms_drift = RootMeanSquares(drifts);
  summary.rms_scale = RootMeanSquares(scales);
  summary.best = BestSingle(summary.rms_drift);
  summary.ratio = RatioToBest(summary.rms_drift);
  Resample(drifts, summary);
  return summary;
}

nlohmann::json ToJson(const PlaceRun& run) {
  return {{"place", run.place},
          {"rig", run.rig},
          {"noise_seed", run.noise_seed},
          {"length_m", run.length},
          {"drift_percent", run.drift_percent},
          {"scale_percent", run.scale_percent}};
}

PlaceRun PlaceRunFromJson(const nlohmann::json& json) {
  PlaceRun run;
  json.at("place").get_to(run.place);
  json.at("rig").get_to(run.rig);
  json.at("noise_seed").get_to(run.noise_seed);
  json.at("length_m").get_to(run.length);
  json.at("drift_percent").get_to(run.drift_percent);
  json.at("scale_percent").get_to(run.scale_percent);
  return run;
}

std::string PlaceTable(const std::vector<PlaceRun>& runs) {
  std::vector<std::vector<PlaceRun>> groups;
  for (const PlaceRun& run : runs) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const std::vector<PlaceRun>& known) {
      return known.front().place == run.place && known.front().rig == run.rig;
    });
    if (group != groups.end())
      group->push_back(run);
    else
      groups.push_back({run});
  }
  if (groups.empty()) return {};
  std::string head = "| place | rig off by | runs | all", rule = "|---|---|---|---";
  for (size_t camera = 1; camera < groups.front().front().drift_percent.size(); ++camera) {
    head += " | cam" + std::to_string(camera - 1);
    rule += "|---";
  }
  std::string table = head + " | all / best | near the luckiest | scale |\n" + rule + "|---|---|---|\n";
  for (const std::vector<PlaceRun>& group : groups) table += TableRow(group.front(), SummarizePlace(group));
  return table;
}

}  // namespace parkade

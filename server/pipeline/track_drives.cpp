#include "server/pipeline/track_drives.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/log.h"
#include "core/options_json.h"
#include "core/sha256.h"
#include "core/version.h"
#include "server/map_folder/odometry_fingerprint.h"
#include "slam/odometry/odometry_file.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

constexpr const char* kOdometryFile = "odometry.bin";

OdometryResult ReadStoredOdometry(const RecordedDrive& log, const BuildScope& scope,
                                  const MapReader& from, const OdometryOptions& options,
                                  const std::filesystem::path& file) {
  if (const auto hash = scope.logs.find(log.name()); hash != scope.logs.end())
    Require(from.MayBeOf(log.name(), hash->second), ErrorCode::kInvalidInput,
            "it is of another log");
  const std::string tracked_by = OdometryFingerprint({{"odometry", OptionsToJson(options)}},
                                                     HealthToJson(log.health()).at("streams"));
  Require(from.OdometryFingerprint(log.name()) == tracked_by, ErrorCode::kInvalidInput,
          "it was tracked with other options or from other streams");
  OdometryResult odometry = ReadOdometry(file, log.rig());
  const TimeSpan stored = odometry.odom_from_body.span(), recorded = log.span();
  Require(recorded.Contains(stored.begin) && recorded.Contains(stored.end),
          ErrorCode::kInvalidInput, "it is of another log");
  return odometry;
}

/// Puts the file into the map in the making, shared with the map that it was taken from.
void StoreOdometry(const OdometryResult& odometry, const DriveLog& log, const BuildScope& scope,
                   bool is_taken) {
  const std::filesystem::path name = std::filesystem::path(log.name()) / kOdometryFile;
  if (is_taken) return LinkOrCopy(scope.from / name, scope.products / name);
  std::filesystem::create_directories(scope.products / log.name());
  WriteOdometry(odometry, log.rig(), scope.products / name);
}

std::string KeyOfOdometry(const BuildScope& scope, const DriveLog& log) {
  const std::string stored =
      scope.products.empty() ? "" : Sha256OfFile(scope.products / log.name() / kOdometryFile);
  return KeyOf({kVersion, std::to_string(kStageResultsVersion), stored});
}

/// Takes the odometry from the map to start from where it holds this drive's; nothing where it
/// cannot be used.
std::optional<OdometryResult> TakeOdometry(const RecordedDrive& log, const BuildContext& context) {
  const std::filesystem::path file = context.scope.from / log.name() / kOdometryFile;
  if (!context.from || !std::filesystem::exists(file)) return std::nullopt;
  try {
    return ReadStoredOdometry(log, context.scope, *context.from, context.options.odometry, file);
  } catch (const Error& error) {
    LogWarning("drive '" + log.name() +
               "' is tracked again, as its stored odometry cannot be used: " + error.what());
    return std::nullopt;
  }
}

DriveInWork TrackDrive(const RecordedDrive& log, const BuildContext& context,
                       const ProgressCallback& progress) {
  DriveInWork drive;
  drive.log = &log;
  std::optional<OdometryResult> taken = TakeOdometry(log, context);
  drive.is_odometry_taken = taken.has_value();
  drive.odometry.value =
      taken ? std::move(*taken) : EstimateTrajectory(log, context.options.odometry, progress);
  if (!context.scope.products.empty())
    StoreOdometry(drive.odometry.value, log, context.scope, drive.is_odometry_taken);
  drive.odometry.key = KeyOfOdometry(context.scope, log);
  return drive;
}

}  // namespace

std::vector<DriveInWork> TrackDrives(std::span<const std::unique_ptr<RecordedDrive>> logs,
                                     const BuildContext& context, Progress& progress,
                                     std::vector<LeftOutDrive>& left_out) {
  std::vector<DriveInWork> drives;
  for (size_t i = 0; i < logs.size(); ++i) {
    try {
      drives.push_back(TrackDrive(*logs[i], context, [&](double fraction) {
        progress.Update((static_cast<double>(i) + fraction) / static_cast<double>(logs.size()));
      }));
      drives.back().index = i;
    } catch (const Error& error) {
      if (logs.size() == 1 || error.code() != ErrorCode::kInvalidInput) throw;
      left_out.push_back({logs[i]->name(), error.what()});
    }
  }
  Require(!drives.empty(), ErrorCode::kInvalidInput,
          "none of the drives can be used; the first: " +
              (left_out.empty() ? "" : left_out.front().reason));
  return drives;
}

}  // namespace parkade

#include "server/pipeline/track_drives.h"

#include "core/error.h"
#include "server/pipeline/kept_odometry.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

DriveInWork TrackDrive(const RecordedDrive& log, const BuildContext& context,
                       const ProgressCallback& progress) {
  DriveInWork drive;
  drive.log = &log;
  if (std::optional<TakenOdometry> taken = TakeOdometry(log, context)) {
    drive.is_odometry_taken = taken->is_of_map;
    drive.odometry.key = ShareOdometry(*taken, log, context);
    drive.odometry.value = std::move(taken->odometry);
  } else {
    drive.odometry.value = EstimateTrajectory(log, context.options.odometry, progress);
    drive.odometry.key = StoreOdometry(drive.odometry.value, log, context);
  }
  const StageFile<SensorAgreement> file{log.name() + kAgreementFile, EncodeAgreement,
                                        DecodeAgreement};
  drive.agreement = Cached(context.cache, file, KeyOfAgreement(drive.odometry.key), [&] {
                      LoadMeasurements(context.scope, log, drive.odometry.value);
                      return MeasureSensorAgreement(drive.odometry.value);
                    }).value;
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

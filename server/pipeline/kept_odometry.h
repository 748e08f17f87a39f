#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/ingest/drive/recorded_drive.h"
#include "server/pipeline/build_context.h"
#include "slam/odometry/odometry_result.h"

namespace parkade {

/// Odometry that an earlier build found.
struct TakenOdometry {
  OdometryResult odometry;  ///< may be without measurements, see LoadMeasurements
  std::filesystem::path file;
  std::string hash;        ///< SHA-256 of the file
  bool is_of_map = false;  ///< of the finished map to start from, not of a build that was ended
};

/// Takes a drive's odometry from the map to start from, else from a build that was ended: nothing
/// where neither holds what this build would find, with a line in the log where it has another.
std::optional<TakenOdometry> TakeOdometry(const RecordedDrive& log, const BuildContext& context);

/// Puts a drive's odometry into the map in the making; returns the key of all that stages depend on
/// which begin with it.
std::string ShareOdometry(const TakenOdometry& taken, const RecordedDrive& log,
                          const BuildContext& context);

/// The same of odometry that this build found, which is kept for a next try as well.
std::string StoreOdometry(const OdometryResult& odometry, const RecordedDrive& log,
                          const BuildContext& context);

/// Reads the measurements of odometry that was taken without.
void LoadMeasurements(const BuildScope& scope, const DriveLog& log, OdometryResult& odometry);

/// How its sensors agree, the first stage after it: the file, beside the drive's name, and the key.
constexpr const char* kAgreementFile = "/agreement.bin";
std::string KeyOfAgreement(const std::string& key_of_odometry);

}  // namespace parkade

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/ingest/containers/raw_message.h"
#include "server/ingest/drive/first_look.h"
#include "server/ingest/drive/recorded_drive.h"

namespace parkade {

struct RecordedDriveParts;

/// Where what was found in a log may be kept: takes the drive's name and what finds it, and gives
/// the bytes that this returned, now or in an earlier build.
using SurveyKeeper =
    std::function<std::string(const std::string& drive, const std::function<std::string()>& find)>;

struct OpenLogOptions {
  std::filesystem::path
      rig_folder{};  ///< Kalibr files (core/rig.h ReadRig); empty: the rig comes from the log
  std::vector<std::string>
      cameras{};  ///< names of the rig's cameras to use, in this order; empty: all
  bool use_wheels = true;
  bool use_gnss = true;
  std::filesystem::path
      scratch_folder{};  ///< where archives are unpacked; empty: the system's temporary folder
  bool warn = true;      ///< log the warnings that health() holds as well
  std::uint64_t large_log = kLargeLog;  ///< of logs of this size, the beginning may decide [byte]
  SurveyKeeper keep_survey{};           ///< asked by OpenDriveLogs; empty: the log is read
  int num_decode_threads = 0;  ///< per pass; 0: one less than core/parallel uses, between 1 and 4
};

/// Opens the drives of a log: one, or several where its clocks leap or it pauses: what lies between
/// two leaps is a drive of its own. The longest comes first and has the log's name, others that
/// with "_part2", "_part3" by time behind it.
///
/// Throws as OpenDriveLog; of a large log before it is read whole, where its beginning shows that
/// it is unusable.
std::vector<std::unique_ptr<RecordedDrive>> OpenDriveLogs(const std::filesystem::path& log,
                                                          const OpenLogOptions& options = {});

/// The same for a log that is open already; `name` may be a file name.
std::vector<std::unique_ptr<RecordedDrive>> OpenDriveLogs(
    const std::shared_ptr<const MessageSource>& log, const std::filesystem::path& name,
    const OpenLogOptions& options);

/// Opens a recorded drive, the longest of the log: a ROS 1 bag, MCAP, rosbag2 (file or folder),
/// EuRoC folder, or an archive of one, recognized by content. Reads the log once without decoding
/// images. An archive is unpacked into a temporary folder that is gone once the drive and its
/// passes are.
///
/// Throws Error{kInvalidInput} (kNotFound where there is no such file) with one sentence that names
/// what is wrong: not a log, no IMU, no images, an uncalibrated camera, a rig that does not fit.
std::unique_ptr<RecordedDrive> OpenDriveLog(const std::filesystem::path& log,
                                            const OpenLogOptions& options = {});

/// The same for a log that is open already; `name` may be a file name.
std::unique_ptr<RecordedDrive> OpenDriveLog(const std::shared_ptr<const MessageSource>& source,
                                            const std::filesystem::path& name,
                                            const OpenLogOptions& options);

/// What OpenDriveLogs makes drives of, for who reads their messages. Throws as OpenDriveLog.
std::vector<std::shared_ptr<RecordedDriveParts>> OpenDriveParts(
    const std::shared_ptr<const MessageSource>& log, const std::filesystem::path& name,
    const OpenLogOptions& options);

/// The rig in `rig_folder`; where that is empty, the one that came with the log (see euroc_rig.h,
/// rig_discovery.h). Throws Error{kInvalidInput} naming what is missing.
Rig FindRig(const MessageSource& source, const std::filesystem::path& rig_folder);

}  // namespace parkade

#include "server/commands/open_logs.h"

#include <algorithm>

#include "core/error.h"
#include "core/version.h"
#include "server/ingest/drive/log_survey.h"
#include "server/map_folder/stage_cache.h"

namespace parkade {
namespace {

/// All that a log's survey depends on.
std::string KeyOfSurvey(const DriveInputs& inputs, const OpenLogOptions& options) {
  std::vector<std::string> parts = {kVersion,
                                    std::to_string(kSurveyVersion),
                                    inputs.log.sha256,
                                    inputs.rig ? inputs.rig->sha256 : "",
                                    options.use_wheels ? "wheels" : "",
                                    options.use_gnss ? "gnss" : ""};
  parts.insert(parts.end(), options.cameras.begin(), options.cameras.end());
  return KeyOf(parts);
}

/// The drives of one log, and what they are made from.
std::pair<std::vector<std::unique_ptr<RecordedDrive>>, DriveInputs> OpenOne(
    const std::string& log, OpenLogOptions options, const BuildFolders& folders) {
  const StageCache cache(folders.from, folders.products, folders.work);
  DriveInputs inputs;
  options.keep_survey = [&](const std::string& drive, const std::function<std::string()>& find) {
    inputs.log = HashInput(log, folders.out);
    if (!options.rig_folder.empty()) inputs.rig = HashInput(options.rig_folder);
    return cache.Get(drive + "/survey.bin", KeyOfSurvey(inputs, options), find);
  };
  auto drives = OpenDriveLogs(log, options);
  return {std::move(drives), std::move(inputs)};
}

}  // namespace

OpenedLogs OpenLogs(const std::vector<std::string>& logs, const std::vector<std::string>& rigs,
                    OpenLogOptions options, bool skips_bad, const BuildFolders& folders) {
  OpenedLogs opened;
  auto& [drives, inputs, unreadable] = opened;
  Require(rigs.size() <= 1 || rigs.size() == logs.size(), ErrorCode::kUsage,
          "--rig is given once for all logs, or once for each, in their order");
  for (size_t i = 0; i < logs.size(); ++i) {
    const std::string rig = rigs.empty() ? "-" : rigs[std::min(i, rigs.size() - 1)];
    options.rig_folder = rig == "-" ? "" : rig;
    std::pair<std::vector<std::unique_ptr<RecordedDrive>>, DriveInputs> of_log;
    try {
      of_log = OpenOne(logs[i], options, folders);
    } catch (const Error& error) {
      if (logs.size() == 1 || error.code() != ErrorCode::kInvalidInput) throw;
      Require(skips_bad, ErrorCode::kInvalidInput,
              "'" + logs[i] + "' cannot be used (--skip-bad maps the others): " + error.what());
      unreadable.push_back({std::filesystem::path(logs[i]).stem(), error.what()});
      continue;
    }
    for (std::unique_ptr<RecordedDrive>& drive : of_log.first) {
      Require(
          inputs.emplace(drive->name(), of_log.second).second, ErrorCode::kInvalidInput,
          "two of the logs are called '" + drive->name() + "'; a drive's name is that of its file");
      drives.push_back(std::move(drive));
    }
  }
  Require(!drives.empty(), ErrorCode::kInvalidInput,
          "none of the logs can be used; the first: " +
              (unreadable.empty() ? "" : unreadable.front().reason));
  // The same drives make the same map, in whatever order they are given.
  std::sort(drives.begin(), drives.end(), [](const auto& a, const auto& b) {
    return std::pair(a->span().begin, a->name()) < std::pair(b->span().begin, b->name());
  });
  return opened;
}

std::vector<std::string> NamesOf(const std::vector<std::unique_ptr<RecordedDrive>>& drives) {
  std::vector<std::string> names;
  names.reserve(drives.size());
  for (const auto& drive : drives) names.push_back(drive->name());
  return names;
}

}  // namespace parkade

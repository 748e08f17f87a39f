#include "server/commands/open_logs.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {

OpenedLogs OpenLogs(const std::vector<std::string>& logs, const std::vector<std::string>& rigs,
                    OpenLogOptions options, bool skips_bad) {
  OpenedLogs opened;
  auto& [drives, sources, unreadable] = opened;
  Require(rigs.size() <= 1 || rigs.size() == logs.size(), ErrorCode::kUsage,
          "--rig is given once for all logs, or once for each, in their order");
  for (size_t i = 0; i < logs.size(); ++i) {
    const std::string rig = rigs.empty() ? "-" : rigs[std::min(i, rigs.size() - 1)];
    options.rig_folder = rig == "-" ? "" : rig;
    std::vector<std::unique_ptr<RecordedDrive>> of_log;
    try {
      of_log = OpenDriveLogs(logs[i], options);
    } catch (const Error& error) {
      if (logs.size() == 1 || error.code() != ErrorCode::kInvalidInput) throw;
      Require(skips_bad, ErrorCode::kInvalidInput,
              "'" + logs[i] + "' cannot be used (--skip-bad maps the others): " + error.what());
      unreadable.push_back({std::filesystem::path(logs[i]).stem(), error.what()});
      continue;
    }
    for (std::unique_ptr<RecordedDrive>& drive : of_log) {
      const DriveSource source{logs[i], options.rig_folder};
      Require(
          sources.emplace(drive->name(), source).second, ErrorCode::kInvalidInput,
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

std::map<std::string, DriveInputs> HashInputs(const std::map<std::string, DriveSource>& sources,
                                              const std::filesystem::path& out) {
  std::map<std::string, DriveInputs> inputs;
  for (const auto& [name, source] : sources) {
    inputs[name].log = HashInput(source.log, out);
    if (!source.rig.empty()) inputs[name].rig = HashInput(source.rig);
  }
  return inputs;
}

}  // namespace parkade

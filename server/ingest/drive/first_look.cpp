#include "server/ingest/drive/first_look.h"

#include <set>

#include "server/ingest/checks/imu_checks.h"

namespace parkade {

namespace fs = std::filesystem;

std::uint64_t SizeOfLog(const fs::path& log) {
  if (!fs::is_directory(log)) return fs::file_size(log);
  std::uint64_t size = 0;
  for (const auto& entry :
       fs::recursive_directory_iterator(log, fs::directory_options::skip_permission_denied))
    if (entry.is_regular_file()) size += entry.file_size();
  return size;
}

bool IsLasting(const Finding& finding) {
  static const std::set<std::string> lasting = {
      "imu_axes",           "imu_axis_dead", "imu_in_cm",       "imu_in_g",
      "imu_in_halves",      "imu_in_mg",     "imu_mounting",    "gyroscope_scale",
      "imu_in_degrees",     "imu_scale",     "imu_upside_down", "imu_without_accelerations",
      "imu_without_gravity"};
  constexpr double kMinWay = 10;  // [m]
  if (finding.severity != Severity::kUnusable) return false;
  return lasting.contains(finding.name) ||
         (finding.name == kImuWithoutRates && finding.evidence.at(kWay) > kMinWay);
}

}  // namespace parkade

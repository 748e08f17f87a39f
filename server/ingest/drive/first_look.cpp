#include "server/ingest/drive/first_look.h"

#include <set>

#include "server/ingest/checks/imu_checks.h"

namespace parkade {

namespace fs = std::filesystem;

std::uint64_t SizeOfLog(const fs::path& log) {
  std::error_code error;
  const auto size_of = [&](const fs::path& path) {
    const bool is_file = fs::is_regular_file(path, error);
    const std::uint64_t size = is_file ? fs::file_size(path, error) : 0;
    return error ? 0 : size;
  };
  if (!fs::is_directory(log, error)) return size_of(log);
  std::uint64_t size = 0;
  fs::recursive_directory_iterator entry(log, fs::directory_options::skip_permission_denied, error);
  for (; entry != fs::end(entry); entry.increment(error)) size += size_of(entry->path());
  return size;
}

bool IsLasting(const Finding& finding) {
  static const std::set<std::string> lasting = {"imu_axes",           "imu_in_cm",
                                                "imu_in_g",           "imu_in_mg",
                                                "imu_mounting",       "gyroscope_scale",
                                                "imu_in_degrees",     "imu_scale",
                                                "imu_upside_down",    "imu_without_accelerations",
                                                "imu_without_gravity"};
  constexpr double kMinWay = 10;  // [m]
  if (finding.severity != Severity::kUnusable) return false;
  return lasting.contains(finding.name) ||
         (finding.name == kImuWithoutRates && finding.evidence.at(kWay) > kMinWay);
}

}  // namespace parkade

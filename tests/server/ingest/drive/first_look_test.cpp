#include "server/ingest/drive/first_look.h"

#include <gtest/gtest.h>

#include "server/ingest/checks/imu_checks.h"
#include "server/ingest/drive/open_drive_log.h"
#include "tests/server/ingest/drive/euroc_folder.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// The findings for which a log is refused; none where it is opened.
std::vector<Finding> WhyRefused(const fs::path& log, std::uint64_t large_log) {
  try {
    OpenDriveLogs(log, {.warn = false, .large_log = large_log});
    return {};
  } catch (const UnusableLog& error) {
    return error.findings();
  }
}

/// A drive of a minute at rest whose accelerations are in g at first, then in m/s2.
void WriteDriveOfTwoUnits(const fs::path& mav0) {
  WriteEurocFolder(mav0, {.seconds = 60, .num_cameras = 1});
  std::string imu = "#timestamp [ns]\n";
  for (std::int64_t i = 0; i <= 6000; ++i)
    imu += std::to_string(1'000'000'000'000 + i * 10'000'000) + ",0,0.01,0.02," +
           (i < 2500 ? "0,0.01,1.01" : "0.01,0,9.81") + "\n";
  WriteText(mav0 / "imu0" / "data.csv", imu);
}

TEST(FirstLook, TheBeginningOfALargeLogDecidesBeforeAllOfItIsRead) {
  const TestFolder folder;
  WriteDriveOfTwoUnits(folder.path() / "mav0");

  const std::vector<Finding> large = WhyRefused(folder.path(), 0);
  const std::vector<Finding> small = WhyRefused(folder.path(), kLargeLog);

  ASSERT_FALSE(large.empty());
  EXPECT_EQ(large[0].name, "imu_in_g");
  EXPECT_TRUE(IsLasting(large[0]));
  for (const Finding& finding : small) EXPECT_NE(finding.name, "imu_in_g");
}

TEST(FirstLook, ALargeLogThatCanBeUsedIsOpenedWhole) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0", {.seconds = 30});

  const auto drives = OpenDriveLogs(folder.path(), {.large_log = 0});

  ASSERT_EQ(drives.size(), 1u);
  EXPECT_NEAR(drives[0]->span().Seconds(), 30, 0.1);
}

TEST(FirstLook, RatesOfACarAtRestMayBeZero) {
  Finding finding{kImuWithoutRates, Severity::kUnusable, "/imu", "", "", {{kWay, 2.0}}};
  EXPECT_FALSE(IsLasting(finding));
  finding.evidence[kWay] = 30;
  EXPECT_TRUE(IsLasting(finding));
  finding.severity = Severity::kWarning;
  EXPECT_FALSE(IsLasting(finding));
}

}  // namespace
}  // namespace parkade

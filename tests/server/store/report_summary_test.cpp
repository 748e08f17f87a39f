#include "server/store/report_summary.h"

#include "core/error.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

TEST(ReportSummary, TakesWhatIsThereAndMissesNothingElse) {
  const TemporaryRoot root;
  WriteText(root.path() / "report.json",
            R"({"datum": null, "drives": [{"name": "a"}, 7, {"streams": []}]})");

  const ReportSummary summary = ReadReportSummary(root.path() / "report.json");

  EXPECT_FALSE(summary.datum.has_value());
  EXPECT_FALSE(summary.bounds.has_value());
  EXPECT_TRUE(summary.streams_of_drive.empty());
}

TEST(ReportSummary, RefusesWhatIsNoObject) {
  const TemporaryRoot root;
  for (const char* text : {"", "[]", "{", "\"report\""}) {
    WriteText(root.path() / "report.json", text);
    EXPECT_THROW(ReadReportSummary(root.path() / "report.json"), Error) << text;
  }
}

}  // namespace
}  // namespace parkade

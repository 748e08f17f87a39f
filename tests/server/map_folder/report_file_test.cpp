#include "server/map_folder/report_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files/file.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

using nlohmann::json;

TEST(ReadReport, LeavesOutThePairsOfJoinAlone) {
  const TemporaryRoot root;
  json report = {{"pairs", 1},
                 {"other", {{"pairs", 1}}},
                 {"drives", {{{"name", "a"}, {"loops", {{"pairs", {1, 2}}}}}}},
                 {"join", {{"adjustment", {{"pairs", 7}}}, {"seconds", 1.5}}}};
  json whole = report;
  whole["join"]["pairs"] = {{{"a", "d1"}, {"links", {{{"id", "d1:1~d2:3"}}}}}};
  WriteFileAtomically(root.path() / "report.json", whole.dump());

  EXPECT_EQ(ReadReport(root.path()), report);
}

}  // namespace
}  // namespace parkade

#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Plots : public RunningService {
 protected:
  std::string MappedDrive() {
    return "/api/v1/drives/" + MapNow("log ok\n").at("drives").at(0).get<std::string>();
  }
};

TEST_F(Plots, ComeFromTheMapOfTheDrive) {
  const std::string drive = MappedDrive();
  const Json plots = Get(drive + "/plots");

  EXPECT_EQ(plots.at("site"), "lot");
  EXPECT_EQ(plots.at("version"), 1);
  EXPECT_EQ(plots.at("start"), "10.000000000");
  EXPECT_EQ(plots.at("degraded"), Json::array());
  EXPECT_EQ(plots.at("series").at(0).at("values"), (Json{1.0, 9.0, -5.0, 1.0}));
}

TEST_F(Plots, AreThinnedToTheirExtremes) {
  const Json series = Get(MappedDrive() + "/plots?points=2").at("series").at(0);

  EXPECT_EQ(series.at("values"), (Json{9.0, -5.0}));
  EXPECT_EQ(series.at("times"), (Json{1.0, 2.0}));
  EXPECT_EQ(series.at("count"), 4);
}

TEST_F(Plots, ARangeIsThinnedByItselfAndRunsToItsEdges) {
  const std::string drive = MappedDrive();
  const auto series_of = [&](const std::string& range) {
    return Get(drive + "/plots" + range).at("series").at(0);
  };
  const Json cut = series_of("?from=10.5&to=12.5");
  EXPECT_EQ(cut.at("times"), (Json{0.0, 1.0, 2.0, 3.0})) << "with the next ones on either side";
  EXPECT_EQ(cut.at("count"), 2);
  EXPECT_EQ(series_of("?from=12").at("times"), (Json{1.0, 2.0, 3.0}));
  EXPECT_EQ(series_of("?to=10").at("times"), (Json{0.0, 1.0}));
  const Json thin = series_of("?from=11&to=13&points=2");
  EXPECT_EQ(thin.at("times"), (Json{0.0, 1.0, 2.0})) << "the extremes of the range";
  EXPECT_EQ(thin.at("count"), 3);
  EXPECT_EQ(series_of("?from=100&to=200").at("count"), 0);
}

TEST_F(Plots, KeyframesAreThinnedAndCut) {
  const std::string drive = MappedDrive();

  EXPECT_EQ(Get(drive + "/keyframes").at("keyframes").size(), 3u);
  const Json cut = Get(drive + "/keyframes?from=10.5&to=12");
  EXPECT_EQ(cut.at("count"), 2);
  EXPECT_EQ(cut.at("keyframes").at(0).at("time"), "11.000000000");
  const Json thin = Get(drive + "/keyframes?points=2");
  EXPECT_EQ(thin.at("count"), 3);
  EXPECT_EQ(thin.at("keyframes").size(), 2u);
}

TEST_F(Plots, SayWhatIsWrong) {
  const std::string drive = MappedDrive();
  for (const std::string what : {"/plots", "/keyframes"}) {
    ExpectProblem(client().Get("/api/v1/drives/0123456789abcdef" + what), 404, "not_found");
    ExpectProblem(client().Get(drive + what + "?version=2"), 404, "not_found");
    ExpectProblem(client().Get(drive + what + "?version=x"), 400, "invalid_input");
    for (const char* points : {"1", "x", "1e3", "20001", "-4"})
      ExpectProblem(client().Get(drive + what + "?points=" + points), 400, "invalid_input");
  }
  for (const std::string what : {"/plots", "/keyframes"})
    for (const char* range : {"?from=noon", "?to=1m", "?from=12&to=11"})
      ExpectProblem(client().Get(drive + what + range), 400, "invalid_input");
}

TEST_F(Plots, ADriveWithoutAMapHasNone) {
  const Json job = MapNow("log bad-input\n");
  const std::string drive = "/api/v1/drives/" + job.at("drives").at(0).get<std::string>();

  ExpectProblem(client().Get(drive + "/plots"), 409, "conflict");
  ExpectProblem(client().Get(drive + "/keyframes"), 409, "conflict");
}

TEST_F(Plots, AreOfTheVersionThatIsAskedFor) {
  const std::string drive = MappedDrive();
  MapNow("log ok\n", "?filename=other&site=lot");  // version 2 holds the other drive alone

  ExpectProblem(client().Get(drive + "/plots?version=2"), 404, "not_found");
  EXPECT_EQ(Get(drive + "/plots?version=1").at("version"), 1);
}

}  // namespace
}  // namespace parkade

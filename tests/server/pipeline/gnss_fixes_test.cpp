#include "server/pipeline/gnss_fixes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/api_description.h"

namespace parkade {
namespace {

using nlohmann::json;

const SiteDatum kDatum{48, 11, 500};

/// Two seconds along x at 1 m/s, from 100 s on; the antenna is 2 m above.
SiteDrive Forwards() {
  SiteDrive drive;
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 20; ++i) {
    TrajectoryState& state = states.emplace_back();
    state.time = TimestampFromSeconds(100 + 0.1 * i);
    state.world_from_body.translation = {0.1 * i, 0, 0};
  }
  drive.site_from_body_trajectory = Trajectory(std::move(states));
  return drive;
}

GnssFix FixAt(double time, const Eigen::Vector3d& position, double sigma = 1) {
  const Geodetic place = GeodeticFromSite(kDatum, position);
  return {TimestampFromSeconds(time),
          place.latitude_deg,
          place.longitude_deg,
          place.altitude,
          {sigma, sigma, 2 * sigma}};
}

json Encoded(const std::vector<GnssFix>& fixes, const std::optional<GnssAlignment>& alignment) {
  const GnssPositions gnss{fixes, {0, 0, 2}, {}};
  return json::parse(EncodeGnssFixes(Forwards(), gnss, alignment, kDatum).value());
}

TEST(GnssFixes, LieInTheSiteAndSayHowFarTheyAreOff) {
  const json all = Encoded({FixAt(101, {1, 3, 1.5})}, GnssAlignment{});

  EXPECT_EQ(MismatchWith("GnssFixes", all), "");
  EXPECT_EQ(all.at("start"), "100.000000000");
  const json fix = all.at("fixes").at(0);
  EXPECT_EQ(fix.at("time"), 1.0);
  EXPECT_NEAR(fix.at("position").at(1).get<double>(), 3, 1e-3);
  EXPECT_NEAR(fix.at("error").get<double>(), 3, 1e-3);
  EXPECT_NEAR(fix.at("error_up").get<double>(), -0.5, 1e-3);
  EXPECT_EQ(fix.at("sigma"), (json{1.0, 1.0, 2.0}));
  EXPECT_EQ(fix.at("state"), "used");
}

TEST(GnssFixes, SayWhyTheyWereNotUsed) {
  const std::vector<GnssFix> fixes = {FixAt(100.5, {0.5, 0, 2}), FixAt(101, {90, 0, 2}),
                                      FixAt(101.5, {1.5, 0, 2}, 50), FixAt(200, {0, 0, 2})};
  GnssAlignment alignment;
  alignment.outliers = {fixes[1].time};
  const auto states_of = [](const json& all) {
    std::vector<std::string> states;
    for (const json& fix : all.at("fixes")) states.push_back(fix.at("state"));
    return states;
  };
  EXPECT_EQ(states_of(Encoded(fixes, alignment)),
            (std::vector<std::string>{"used", "outlier", "vague", "outside"}));
  EXPECT_EQ(states_of(Encoded(fixes, std::nullopt)),
            (std::vector<std::string>{"unaligned", "unaligned", "vague", "outside"}));
  EXPECT_FALSE(Encoded(fixes, alignment).at("fixes").at(3).contains("error"));
}

TEST(GnssFixes, WithoutAPlaceOnEarthThereAreNone) {
  const GnssPositions gnss{{FixAt(101, {1, 0, 2})}, {}, {}};
  EXPECT_FALSE(EncodeGnssFixes(Forwards(), gnss, std::nullopt, std::nullopt));
  EXPECT_FALSE(EncodeGnssFixes(Forwards(), {}, std::nullopt, kDatum));
}

}  // namespace
}  // namespace parkade

#include "slam/georeference/fit_pins.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"

namespace parkade {
namespace {

const SiteDatum kTruth{48.137154, 11.576124, 519.3};
const Rigid3 kTruthFromSite{Eigen::Quaterniond(Eigen::AngleAxisd(2.1, Eigen::Vector3d::UnitZ())),
                            {31, -12, 4.5}};

PinnedPoint Pin(const Eigen::Vector3d& point_in_site, bool has_height = true) {
  const Geodetic place = GeodeticFromSite(kTruth, kTruthFromSite * point_in_site);
  PinnedPoint pin{point_in_site, place.latitude_deg, place.longitude_deg, std::nullopt};
  if (has_height) pin.height = place.altitude;
  return pin;
}

/// [m] between where the fit puts a point and where it is.
Eigen::Vector3d ErrorAt(const PinFit& fit, const Eigen::Vector3d& point_in_site) {
  const Eigen::Vector3d found = EarthFromSite(fit.datum) * (fit.pinned_from_site * point_in_site);
  return EarthFromSite(kTruth).rotation.conjugate() *
         (found - EarthFromSite(kTruth) * (kTruthFromSite * point_in_site));
}

std::string SentenceOf(const std::vector<PinnedPoint>& pins) {
  try {
    RequireAgreement(FitPins(pins, {}), {});
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    return error.what();
  }
  return "";
}

TEST(FitPins, TwoExactPinsPutTheSiteWhereItIs) {
  const PinFit fit = FitPins({Pin({0, 0, 0}), Pin({60, 25, 1})}, {});

  EXPECT_LT(ErrorAt(fit, {100, -40, 2}).norm(),
            2e-3);  // tangent planes 40 m apart differ by that much
  EXPECT_LT(fit.residuals[fit.WorstPin()].norm(), 1e-3);
  EXPECT_LT((fit.pinned_from_site * Eigen::Vector3d(0, 0, 0)).norm(), 1e-3)
      << "the datum is at the first pin";
  EXPECT_TRUE(fit.datum.is_altitude_known);
}

TEST(FitPins, WithoutHeightsTheSiteKeepsTheHeightItHas) {
  const std::vector<PinnedPoint> pins = {Pin({0, 0, 2}, false), Pin({60, 25, 3}, false)};
  const SiteDatum by_gnss{48.1, 11.5, 500};
  const PinFit unknown = FitPins(pins, {}), known = FitPins(pins, {}, by_gnss, 4.0);

  EXPECT_FALSE(unknown.datum.is_altitude_known);
  EXPECT_EQ(unknown.datum.altitude, 0);
  EXPECT_TRUE(std::isinf(unknown.placement.covariance(3, 3)));
  EXPECT_TRUE(known.datum.is_altitude_known);
  EXPECT_NEAR(known.datum.altitude, 502, 1e-3);
  EXPECT_EQ(known.placement.covariance(3, 3), 4.0);
  EXPECT_LT(ErrorAt(known, {30, 10, 2}).head<2>().norm(), 2e-3);
}

TEST(FitPins, OnePinWithAHeightGivesAllOfThemTheirs) {
  const PinFit fit =
      FitPins({Pin({0, 0, 0}, false), Pin({60, 25, 1}), Pin({10, 45, -1}, false)}, {});

  EXPECT_LT(ErrorAt(fit, {100, -40, 2}).norm(), 2e-3);
  EXPECT_EQ(fit.residuals[0].z(), 0);
}

TEST(FitPins, TheCovarianceIsThatOfTheErrors) {
  std::mt19937 random(7);
  PinOptions options;
  std::normal_distribution<double> noise(0, options.sigma);
  constexpr int kRuns = 400;
  double squared_yaw = 0, claimed_yaw = 0;
  Eigen::Vector3d squared = Eigen::Vector3d::Zero(), claimed = Eigen::Vector3d::Zero();
  const Eigen::Vector3d far(150, 30, 0);
  for (int run = 0; run < kRuns; ++run) {
    std::vector<PinnedPoint> pins;
    for (const Eigen::Vector3d& point :
         {Eigen::Vector3d(0, 0, 0), {50, 0, 0}, {50, 30, 0}, {0, 30, 0}}) {
      pins.push_back(Pin(point));
      pins.back().point_in_site += Eigen::Vector3d(noise(random), noise(random), noise(random));
    }
    const PinFit fit = FitPins(pins, options);
    const Eigen::Vector3d error = EarthFromSite(fit.datum).rotation.conjugate() *
                                  (EarthFromSite(kTruth).rotation * ErrorAt(fit, far));
    squared += error.cwiseAbs2();
    claimed += fit.placement.PositionSigma(fit.pinned_from_site * far).cwiseAbs2();
    const double yaw =
        (fit.pinned_from_site.rotation * kTruthFromSite.rotation.conjugate()).z() * 2;
    squared_yaw += yaw * yaw;
    claimed_yaw += std::pow(fit.placement.YawSigma(), 2);
  }
  // Residuals raise the claim where they are large by chance, so that it is a little above what the
  // errors are.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(squared[axis] / claimed[axis], 0.5);
    EXPECT_LT(squared[axis] / claimed[axis], 1.2);
  }
  EXPECT_GT(squared_yaw / claimed_yaw, 0.5);
  EXPECT_LT(squared_yaw / claimed_yaw, 1.2);
}

TEST(FitPins, PinsThatDoNotFitEachOtherAreNamed) {
  std::vector<PinnedPoint> pins = {Pin({0, 0, 0}), Pin({60, 25, 1}), Pin({10, 45, 0})};
  EXPECT_EQ(SentenceOf(pins), "");
  pins[1].point_in_site.x() += 9;
  EXPECT_NE(SentenceOf(pins).find("pin 2 lies "), std::string::npos) << SentenceOf(pins);
}

TEST(FitPins, WhatPinsNothingIsRefusedInOneSentence) {
  EXPECT_NE(SentenceOf({Pin({0, 0, 0})}).find("two points or more"), std::string::npos);
  EXPECT_NE(SentenceOf({Pin({0, 0, 0}), Pin({0, 0, 0})}).find("0.00 m of each other"),
            std::string::npos);
  EXPECT_NE(SentenceOf({Pin({0, 0, 0}), Pin({0, 0, 30})}).find("of each other"), std::string::npos);
  PinnedPoint nowhere = Pin({30, 0, 0});
  nowhere.latitude_deg = 91;
  EXPECT_NE(SentenceOf({Pin({0, 0, 0}), nowhere}).find("latitude of pin 2"), std::string::npos);
  nowhere.latitude_deg = NAN;
  EXPECT_NE(SentenceOf({Pin({0, 0, 0}), nowhere}).find("latitude of pin 2"), std::string::npos);
  nowhere = Pin({30, 0, 0});
  nowhere.height = 51900;
  EXPECT_NE(SentenceOf({Pin({0, 0, 0}), nowhere}).find("height of pin 2"), std::string::npos);
}

}  // namespace
}  // namespace parkade

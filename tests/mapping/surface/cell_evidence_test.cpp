#include "mapping/surface/cell_evidence.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

constexpr ViewSet kFromNear = 1, kFromBehind = 2;

CellObservation Seen(float log_odds, ViewSet view) {
  return {.color = {90, 90, 90, 200}, .log_odds = log_odds, .view = view};
}

/// A drive that looks three times.
void Look(float log_odds, ViewSet view, CellEvidence& evidence) {
  for (int i = 0; i < 3; ++i) evidence.Count(Seen(log_odds, view));
  evidence.EndDrive();
}

void ExpectSame(const ObservationSummary& a, const ObservationSummary& b) {
  EXPECT_EQ(a.free, b.free);
  EXPECT_EQ(a.occupied, b.occupied);
  EXPECT_EQ(a.free_views, b.free_views);
  EXPECT_EQ(a.occupied_views, b.occupied_views);
}

TEST(CellEvidence, IsSummedUpAsTheLatestDriveShowsIt) {
  CellEvidence monday, both;
  Look(0.8F, kFromNear, monday);
  Look(-0.8F, kFromBehind, both);  // a car stood there the day before
  Look(0.8F, kFromNear, both);
  EXPECT_GT(both.log_odds, 0);
  EXPECT_EQ(both.shown.log_odds, monday.shown.log_odds);
  EXPECT_GT(both.Summary().free, 0);
  ExpectSame(both.Summary(), monday.Summary());
}

TEST(CellEvidence, AGlimpseThatTellsNothingTakesNothingAway) {
  CellEvidence monday, both;
  Look(0.8F, kFromNear, monday);
  Look(0.8F, kFromNear, both);
  Look(-1e-6F, 0, both);
  ExpectSame(both.Summary(), monday.Summary());

  CellEvidence doubtful;
  Look(0.1F, 0, doubtful);
  EXPECT_GT(doubtful.Summary().free, 0) << "better than nothing";
}

TEST(CellEvidence, WhatHidesGroundThatWasSeenFromThereCoversIt) {
  CellEvidence evidence;
  Look(0.8F, kFromNear, evidence);
  Look(-0.8F, kFromNear, evidence);
  EXPECT_LT(evidence.log_odds, 0);
  EXPECT_EQ(evidence.Summary().free, 0);
  EXPECT_EQ(evidence.Summary().occupied_views, 1);
}

}  // namespace
}  // namespace parkade

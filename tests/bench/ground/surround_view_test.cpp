#include "tests/bench/ground/surround_view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/server/ingest/drive/euroc_folder.h"

namespace parkade {
namespace {

/// Needs PARKADE_SHARED_DATA or ../shared/data.
TEST(SurroundView, PaintOfARealGarageJoinsThroughTheOcamModel) {
  const std::filesystem::path folder = SharedData() / "surround_garage";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "PARKADE_SHARED_DATA has no surround_garage";
  SurroundRig rig = ReadOpenCalib(folder);
  for (const SurroundCamera& camera : rig.cameras) EXPECT_LT(camera.fit_error, 0.05) << camera.name;

  AlignNeighbors(rig);

  const std::vector<double> agreements = AgreementOfNeighbors(rig, 1);
  EXPECT_GT(*std::min_element(agreements.begin(), agreements.end()), 0.35);
}

}  // namespace
}  // namespace parkade

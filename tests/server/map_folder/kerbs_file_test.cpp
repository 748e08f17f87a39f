#include "server/map_folder/kerbs_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files/file.h"
#include "export/markings.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

const Kerb kKerb{{{1, 2, 3}, {4, 2, 3}, {7, 3, 3.2}}, 0.117, 0.006, 2.5};

TEST(KerbsFile, HoldsWhatWasWrittenAmongOtherThings) {
  const TemporaryRoot root;
  const std::filesystem::path file = root.path() / "markings.geojson";
  GroundMarkings markings;
  markings.bumps.push_back({{7, 8, 0.1}, 1, 0.06, 3.2, 2});
  markings.kerbs.push_back(kKerb);
  SiteDatum flat{48, 11, 0};
  flat.is_altitude_known = false;
  for (const std::optional<SiteDatum>& datum :
       {std::optional<SiteDatum>{}, {SiteDatum{48, 11, 500}}, {flat}}) {
    WriteFileAtomically(file, EncodeMarkingsGeoJson(markings, {}, datum));
    const std::vector<Kerb> kerbs = ReadKerbs(file);
    ASSERT_EQ(kerbs.size(), 1U);
    ASSERT_EQ(kerbs[0].points.size(), 3U);
    for (size_t i = 0; i < 3; ++i) EXPECT_LT((kerbs[0].points[i] - kKerb.points[i]).norm(), 0.001);
    EXPECT_NEAR(kerbs[0].height, 0.117, 1e-9);
    EXPECT_NEAR(kerbs[0].height_sigma, 0.006, 1e-9);
    EXPECT_NEAR(kerbs[0].hidden_length, 2.5, 1e-9);
  }
}

TEST(KerbsFile, TrueKerbsMayBeInTheSiteOnEarthOrInTheirWorld) {
  const TemporaryRoot root;
  const std::filesystem::path file = root.path() / "kerbs.geojson";
  const SiteDatum datum{48, 11, 500};
  GroundMarkings markings;
  markings.kerbs.push_back(kKerb);
  for (const std::optional<SiteDatum>& written : {std::optional<SiteDatum>{}, {datum}}) {
    WriteFileAtomically(file, EncodeMarkingsGeoJson(markings, {}, written));
    const std::vector<TrueKerb> kerbs = ReadTrueKerbs(file, datum);
    ASSERT_EQ(kerbs.size(), 2U) << "one for each of its straight pieces";
    EXPECT_LT((kerbs[1].begin - kKerb.points[1]).norm(), 0.002);
    EXPECT_LT((kerbs[1].end - kKerb.points[2]).norm(), 0.002);
    EXPECT_NEAR(kerbs[1].height, 0.117, 1e-9);
  }
  EXPECT_THROW(ReadTrueKerbs(file, {}), Error) << "on Earth, and nothing says where that is";
  WriteFileAtomically(file, R"({"features": [{"geometry": {"coordinates": [[0, 0, 0], [1, 1, 1]]},
                                "properties": {"type": "kerb", "height_m": 0.1, "line": [[5, 6, 7], [6, 6, 7]]}}]})");
  EXPECT_EQ(ReadTrueKerbs(file, {}).at(0).begin, Eigen::Vector3d(5, 6, 7));
}

TEST(KerbsFile, SomethingElseIsRefused) {
  const TemporaryRoot root;
  const std::filesystem::path file = root.path() / "markings.geojson";
  for (const char* text : {"", "[]", R"({"features": 1})", R"({"features": [{"geometry": null}]})",
                           R"({"features": [{"properties": {"type": "kerb"}}]})"}) {
    WriteFileAtomically(file, text);
    EXPECT_THROW(ReadKerbs(file), Error) << text;
    EXPECT_THROW(ReadTrueKerbs(file, {}), Error) << text;
  }
}

}  // namespace
}  // namespace parkade

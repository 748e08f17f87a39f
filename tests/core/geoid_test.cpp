#include "core/geoid.h"

#include <fstream>

#include "tests/support/geoid_folder.h"

namespace parkade {
namespace {

TEST_F(GeoidFolder, WithoutAFileThereIsNoGeoid) { EXPECT_FALSE(Geoid::Find()); }

TEST_F(GeoidFolder, AGridIsInterpolated) {
  WriteGrid("egm2008-5");
  const std::optional<Geoid> geoid = Geoid::Find();

  ASSERT_TRUE(geoid);
  EXPECT_EQ(geoid->name(), "egm2008-5");
  EXPECT_NEAR(geoid->Undulation(30, 60), UndulationAt(30), 0.01);
  EXPECT_NEAR(geoid->Undulation(41.5, 11.5), UndulationAt(41.5),
              0.05);  // linear but for the cubic's smoothing
}

TEST_F(GeoidFolder, Egm96ComesFirstAsKmlCountsFromIt) {
  WriteGrid("egm2008-1");
  WriteGrid("egm96-15");
  EXPECT_EQ(Geoid::Find()->name(), "egm96-15");
}

TEST_F(GeoidFolder, ADamagedFileIsPassedOver) {
  std::ofstream(folder_ / "egm96-5.pgm") << "P5\n# Offset -108\n";
  EXPECT_FALSE(Geoid::Find());
  WriteGrid("egm2008-1");
  EXPECT_EQ(Geoid::Find()->name(), "egm2008-1");
}

}  // namespace
}  // namespace parkade

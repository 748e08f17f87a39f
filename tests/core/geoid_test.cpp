#include "core/geoid.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// A folder that stands for the one of the geoid's data files.
class GeoidFolder : public testing::Test {
 protected:
  GeoidFolder() {
    fs::create_directories(folder_);
    ::setenv("GEOGRAPHICLIB_GEOID_PATH", folder_.c_str(), 1);
    ::unsetenv("GEOGRAPHICLIB_GEOID_NAME");
  }
  ~GeoidFolder() override {
    ::unsetenv("GEOGRAPHICLIB_GEOID_PATH");
    fs::remove_all(folder_);
  }

  /// GeographicLib's format: a PGM of 16 bits, big endian, from 90 N 0 E eastwards and southwards, here every 30
  /// degrees; undulation = offset + scale * number.
  void WriteGrid(const std::string& name) const {
    constexpr int kWidth = 12, kHeight = 7;
    std::ofstream file(folder_ / (name + ".pgm"), std::ios::binary);
    file << "P5\n# Geoid file in PGM format for the GeographicLib::Geoid class\n# Description synthetic\n"
            "# Offset -108\n# Scale 0.003\n# Origin 90N 0E\n# AREA_OR_POINT Point\n"
         << kWidth << " " << kHeight << "\n65535\n";
    for (int row = 0; row < kHeight; ++row)
      for (int column = 0; column < kWidth; ++column) {
        const int value = static_cast<int>(std::lround((UndulationAt(90 - 30 * row) + 108) / 0.003));
        file.put(static_cast<char>(value >> 8)).put(static_cast<char>(value & 255));
      }
  }

  static double UndulationAt(double latitude_deg) { return 20 + latitude_deg / 3; }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("geoids_" + std::to_string(::getpid()));
};

TEST_F(GeoidFolder, WithoutAFileThereIsNoGeoid) { EXPECT_FALSE(Geoid::Find()); }

TEST_F(GeoidFolder, AGridIsInterpolated) {
  WriteGrid("egm2008-5");
  const std::optional<Geoid> geoid = Geoid::Find();

  ASSERT_TRUE(geoid);
  EXPECT_EQ(geoid->name(), "egm2008-5");
  EXPECT_NEAR(geoid->Undulation(30, 60), UndulationAt(30), 0.01);
  EXPECT_NEAR(geoid->Undulation(41.5, 11.5), UndulationAt(41.5), 0.05);  // linear but for the cubic's smoothing
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

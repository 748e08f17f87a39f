#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace parkade {

/// A folder that stands for the one of the geoid's data files.
class GeoidFolder : public testing::Test {
 protected:
  GeoidFolder() {
    std::filesystem::create_directories(folder_);
    ::setenv("GEOGRAPHICLIB_GEOID_PATH", folder_.c_str(), 1);
    ::unsetenv("GEOGRAPHICLIB_GEOID_NAME");
  }
  ~GeoidFolder() override {
    ::unsetenv("GEOGRAPHICLIB_GEOID_PATH");
    std::filesystem::remove_all(folder_);
  }

  /// GeographicLib's format: a PGM of 16 bits, big endian, from 90 N 0 E eastwards and southwards,
  /// here every 30 degrees; undulation = offset + scale * number.
  void WriteGrid(const std::string& name) const {
    constexpr int kWidth = 12, kHeight = 7;
    std::ofstream file(folder_ / (name + ".pgm"), std::ios::binary);
    file << "P5\n# Geoid file in PGM format for the GeographicLib::Geoid class\n# Description "
            "synthetic\n"
            "# Offset -108\n# Scale 0.003\n# Origin 90N 0E\n# AREA_OR_POINT Point\n"
         << kWidth << " " << kHeight << "\n65535\n";
    for (int row = 0; row < kHeight; ++row)
      for (int column = 0; column < kWidth; ++column) {
        const int value =
            static_cast<int>(std::lround((UndulationAt(90 - 30 * row) + 108) / 0.003));
        file.put(static_cast<char>(value >> 8)).put(static_cast<char>(value & 255));
      }
  }

  static double UndulationAt(double latitude_deg) { return 20 + latitude_deg / 3; }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("geoids_" + std::to_string(::getpid()));
};

}  // namespace parkade

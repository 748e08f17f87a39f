#include "core/geoid.h"

#include <GeographicLib/Geoid.hpp>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/log.h"

namespace parkade {
namespace {

// KML counts heights from EGM96. The others lie within a meter of it.
constexpr std::array kModels = {"egm96-5", "egm96-15", "egm2008-1", "egm2008-2_5", "egm2008-5"};

}  // namespace

Geoid::Geoid(std::string name, std::shared_ptr<const GeographicLib::Geoid> grid)
    : name_(std::move(name)), grid_(std::move(grid)) {}

std::optional<Geoid> Geoid::Find() {
  std::vector<std::string> names(kModels.begin(), kModels.end());
  if (const char* name = std::getenv("GEOGRAPHICLIB_GEOID_NAME")) names.insert(names.begin(), name);
  const std::filesystem::path folder = GeographicLib::Geoid::DefaultGeoidPath();
  for (const std::string& name : names) {
    std::error_code ignored;
    if (!std::filesystem::exists(folder / (name + ".pgm"), ignored)) continue;
    try {
      return Geoid(name, std::make_shared<const GeographicLib::Geoid>(name, folder.string()));
    } catch (const GeographicLib::GeographicErr& error) {
      LogWarning("the geoid file " + name + ".pgm cannot be used: " + error.what());
    }
  }
  return std::nullopt;
}

double Geoid::Undulation(double latitude_deg, double longitude_deg) const {
  try {
    return (*grid_)(latitude_deg, longitude_deg);
  } catch (const GeographicLib::GeographicErr&) {
    throw Error(ErrorCode::kInvalidInput,
                "the geoid file " + name_ + ".pgm cannot be read: it is damaged");
  }
}

}  // namespace parkade

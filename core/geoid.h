#pragma once

#include <memory>
#include <optional>
#include <string>

namespace GeographicLib {  // NOLINT(readability-identifier-naming): theirs
class Geoid;
}

namespace parkade {

/// Mean sea level as a surface above the WGS84 ellipsoid, from a data file of GeographicLib.
class Geoid {
 public:
  /// The model that GEOGRAPHICLIB_GEOID_NAME names, else the first there is of egm96-5, egm96-15,
  /// egm2008-1, egm2008-2_5 and egm2008-5: NAME.pgm in GEOGRAPHICLIB_GEOID_PATH, else in
  /// GeographicLib's own folder. Nothing where there is none; a file that cannot be read is
  /// skipped, with a warning.
  static std::optional<Geoid> Find();

  /// [m] of mean sea level above the ellipsoid: height above sea = ellipsoidal height - undulation.
  /// Throws Error{kInvalidInput} where the file is cut off. Not thread-safe.
  double Undulation(double latitude_deg, double longitude_deg) const;

  const std::string& name() const { return name_; }

 private:
  Geoid(std::string name, std::shared_ptr<const GeographicLib::Geoid> grid);

  std::string name_;
  std::shared_ptr<const GeographicLib::Geoid> grid_;
};

}  // namespace parkade

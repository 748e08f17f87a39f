#include "export/map_projector.h"

#include <cstdio>

namespace parkade {

MapProjector::MapProjector(const std::optional<SiteDatum>& datum) : datum_(datum) {
  if (!datum) return;
  origin_.latitude_deg = datum->latitude_deg;
  origin_.longitude_deg = datum->longitude_deg;
}

Geodetic MapProjector::Unproject(const Eigen::Vector3d& point_in_site) const {
  Geodetic geodetic = GeodeticFromSite(origin_, point_in_site);
  if (!datum_) geodetic.altitude = point_in_site.z();
  return geodetic;
}

std::string MapProjector::EncodeInfo() const {
  if (!datum_) return "projector_type: Local\n";
  char height[64] = "at a height that is not known";
  if (datum_->is_altitude_known)
    std::snprintf(height, sizeof height, "%.4f m above the ellipsoid", datum_->altitude);
  char text[512];
  std::snprintf(text, sizeof text,
                "projector_type: LocalCartesian\nvertical_datum: WGS84\n"
                "map_origin:  # %s; altitudes in this map are relative to it\n"
                "  latitude: %.10f\n  longitude: %.10f\n  altitude: 0.0\n",
                height, datum_->latitude_deg, datum_->longitude_deg);
  return text;
}

}  // namespace parkade

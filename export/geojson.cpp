#include "export/geojson.h"

#include <cstdio>

namespace parkade {
namespace {

std::string FormatRing(const Ring& ring, const std::optional<SiteDatum>& datum) {
  std::string text = "[";
  for (const Eigen::Vector3d& point : ring) text += FormatPosition(point, datum) + ",";
  return text + FormatPosition(ring.front(), datum) + "]";
}

}  // namespace

std::string FormatPosition(const Eigen::Vector3d& point_in_site,
                           const std::optional<SiteDatum>& datum) {
  char text[128];
  if (datum) {
    const Geodetic geodetic = GeodeticFromSite(*datum, point_in_site);
    if (!datum->is_altitude_known) {
      std::snprintf(text, sizeof text, "[%.9f,%.9f]", geodetic.longitude_deg,
                    geodetic.latitude_deg);
      return text;
    }
    std::snprintf(text, sizeof text, "[%.9f,%.9f,%.3f]", geodetic.longitude_deg,
                  geodetic.latitude_deg, geodetic.altitude);
  } else {
    std::snprintf(text, sizeof text, "[%.3f,%.3f,%.3f]", point_in_site.x(), point_in_site.y(),
                  point_in_site.z());
  }
  return text;
}

std::string FormatPolygon(const std::vector<Ring>& rings, const std::optional<SiteDatum>& datum) {
  std::string text;
  for (const Ring& ring : rings) text += (text.empty() ? "" : ",") + FormatRing(ring, datum);
  return "[" + text + "]";
}

std::string FormatFeatureCollection(const std::vector<std::string>& features,
                                    const std::optional<SiteDatum>& datum) {
  std::string text;
  for (const std::string& feature : features) text += (text.empty() ? "\n" : ",\n") + feature;
  const std::string frame = datum ? "" : R"("frame":"site","units":"m",)";
  return R"({"type":"FeatureCollection",)" + frame + R"("features":[)" + text + "\n]}\n";
}

}  // namespace parkade

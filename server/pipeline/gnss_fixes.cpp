#include "server/pipeline/gnss_fixes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

/// A receiver knows no tenth of a millimeter: few digits keep the file small.
double Rounded(double value) { return std::round(value * 1e3) / 1e3; }

Json NumbersOf(const Eigen::Vector3d& vector) {
  return {Rounded(vector.x()), Rounded(vector.y()), Rounded(vector.z())};
}

const char* StateOf(const GnssFix& fix, const Trajectory& site_from_body,
                    const GnssAlignOptions& options,
                    const std::optional<GnssAlignment>& alignment) {
  if (!site_from_body.span().Contains(fix.time)) return "outside";
  if (!IsUsable(fix, site_from_body, options.max_fix_sigma)) return "vague";
  if (!alignment) return "unaligned";
  const auto& outliers = alignment->outliers;
  return std::find(outliers.begin(), outliers.end(), fix.time) == outliers.end() ? "used"
                                                                                 : "outlier";
}

}  // namespace

std::optional<std::string> EncodeGnssFixes(const SiteDrive& drive, const GnssPositions& gnss,
                                           const std::optional<GnssAlignment>& alignment,
                                           const std::optional<SiteDatum>& datum) {
  if (!datum || gnss.fixes.empty()) return std::nullopt;
  const Trajectory& site_from_body = drive.site_from_body_trajectory;
  const Timestamp start = site_from_body.span().begin;
  Json fixes = Json::array();
  for (const GnssFix& fix : gnss.fixes) {
    const Eigen::Vector3d position =
        SiteFromGeodetic(*datum, fix.latitude_deg, fix.longitude_deg, fix.altitude);
    if (!position.allFinite()) continue;
    Json json = {{"time", Rounded(fix.time - start)},
                 {"position", NumbersOf(position)},
                 {"sigma", NumbersOf(fix.sigma_enu)},
                 {"state", StateOf(fix, site_from_body, gnss.options, alignment)}};
    if (const std::optional<Rigid3> pose = site_from_body.At(fix.time)) {
      const Eigen::Vector3d off = position - *pose * gnss.antenna_in_body;
      json["error"] = Rounded(off.head<2>().norm());
      json["error_up"] = Rounded(off.z());
    }
    fixes.push_back(std::move(json));
  }
  const Json json = {{"start", ToDecimalSeconds(start)},
                     {"max_sigma", gnss.options.max_fix_sigma},
                     {"fixes", std::move(fixes)}};
  return json.dump() + "\n";
}

}  // namespace parkade

#include "export/trajectory_files.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/yaw.h"

namespace parkade {
namespace {

constexpr double kMinLineStep = 0.1;  // [m] between the points of a line on a globe

/// The correction site_from_odom over time: known at the states of the final trajectory that lie
/// inside the odometry, interpolated between them and held beyond.
class Correction {
 public:
  explicit Correction(const SiteDrive& drive) {
    for (const TrajectoryState& state : drive.site_from_body_trajectory.states())
      if (const auto odom_from_body = drive.odometry.At(state.time))
        known_.push_back({state.time, state.world_from_body * odom_from_body->Inverse()});
  }

  bool empty() const { return known_.empty(); }

  Rigid3 At(Timestamp time) const {
    const auto after =
        std::lower_bound(known_.begin(), known_.end(), time,
                         [](const TimedPose& pose, Timestamp t) { return pose.time < t; });
    if (after == known_.begin()) return after->world_from_frame;
    const TimedPose& before = *std::prev(after);
    if (after == known_.end()) return before.world_from_frame;
    return Interpolate(before.world_from_frame, after->world_from_frame,
                       (time - before.time) / (after->time - before.time));
  }

 private:
  std::vector<TimedPose> known_;
};

/// The states' times of both trajectories, gaps longer than `max_gap` cut into equal parts.
std::vector<Timestamp> SampleTimes(const SiteDrive& drive, bool uses_odometry, double max_gap) {
  std::vector<Timestamp> known;
  for (const TrajectoryState& state : drive.site_from_body_trajectory.states())
    known.push_back(state.time);
  if (uses_odometry)
    for (const TrajectoryState& state : drive.odometry.states()) known.push_back(state.time);
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());

  std::vector<Timestamp> times;
  for (const Timestamp time : known) {
    if (!times.empty()) {
      const Timestamp begin = times.back();
      const auto num_parts = static_cast<std::int64_t>(std::ceil((time - begin) / max_gap - 1e-9));
      for (std::int64_t part = 1; part < num_parts; ++part)
        times.push_back({begin.ns + (time.ns - begin.ns) / num_parts * part});
    }
    times.push_back(time);
  }
  return times;
}

std::string Format(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

struct GlobePoint {
  Timestamp time;
  std::string longitude, latitude,
      altitude;  ///< decimal: 1e-9 degrees are 0.1 mm; altitude may be empty: unknown

  std::string Text() const {
    return longitude + "," + latitude + (altitude.empty() ? "" : "," + altitude);
  }
};

/// Heights are above the geoid, or the ellipsoid where there is none.
std::vector<GlobePoint> LineOnGlobe(const SiteDrive& drive, const SiteDatum& datum,
                                    const std::optional<Geoid>& geoid = std::nullopt) {
  const Rigid3 imu_from_body = drive.rig.body_from_imu.Inverse();
  std::vector<GlobePoint> line;
  const std::vector<TimedPose> poses = SampleFinalTrajectory(drive);
  std::optional<Eigen::Vector3d> last;
  for (size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Vector3d position = (poses[i].world_from_frame * imu_from_body).translation;
    const bool is_last = i + 1 == poses.size();
    if (last && !is_last && (position - *last).norm() < kMinLineStep) continue;
    const Geodetic geodetic = GeodeticFromSite(datum, position);
    const double sea = geoid ? geoid->Undulation(geodetic.latitude_deg, geodetic.longitude_deg) : 0;
    line.push_back({poses[i].time, Format("%.9f", geodetic.longitude_deg),
                    Format("%.9f", geodetic.latitude_deg),
                    datum.is_altitude_known ? Format("%.3f", geodetic.altitude - sea) : ""});
    last = position;
  }
  return line;
}

std::string DescribeHeights(const SiteDatum& datum, const std::optional<Geoid>& geoid) {
  if (!datum.is_altitude_known) return "Heights are not known: the line is drawn on the ground.";
  if (geoid) return "Heights are above mean sea level (" + geoid->name() + ").";
  return "Heights are above the WGS84 ellipsoid, not above the sea: no geoid model was there.";
}

std::string EscapeXml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      default: escaped += c;
    }
  }
  return escaped;
}

}  // namespace

std::vector<TimedPose> SampleFinalTrajectory(const SiteDrive& drive, double max_gap) {
  const Correction correction(drive);
  std::vector<TimedPose> poses;
  for (const Timestamp time : SampleTimes(drive, !correction.empty(), max_gap)) {
    std::optional<Rigid3> site_from_body;
    if (const auto odom_from_body = drive.odometry.At(time);
        odom_from_body && !correction.empty()) {
      site_from_body = correction.At(time) * *odom_from_body;
    } else {
      site_from_body = drive.site_from_body_trajectory.At(time);
    }
    if (site_from_body) poses.push_back({time, *site_from_body * drive.rig.body_from_imu});
  }
  return poses;
}

std::vector<TimedPose> SampleOdometry(const SiteDrive& drive) {
  if (drive.odometry.empty()) return {};
  Rigid3 site_from_odom;
  const Rigid3& odom_from_start = drive.odometry.states().front().world_from_body;
  if (!drive.site_from_body_trajectory.empty()) {
    const Rigid3 site_from_start =
        SampleFinalTrajectory(drive).front().world_from_frame * drive.rig.body_from_imu.Inverse();
    const double turn = YawOf(site_from_start.rotation) - YawOf(odom_from_start.rotation);
    site_from_odom.rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
    site_from_odom.translation =
        site_from_start.translation - site_from_odom.rotation * odom_from_start.translation;
  }
  std::vector<TimedPose> poses;
  for (const TrajectoryState& state : drive.odometry.states())
    poses.push_back({state.time, site_from_odom * state.world_from_body * drive.rig.body_from_imu});
  return poses;
}

std::string EncodeTrajectoryGeoJson(const SiteDrive& drive, const SiteDatum& datum) {
  const std::vector<GlobePoint> line = LineOnGlobe(drive, datum);
  std::string coordinates, times;
  for (const GlobePoint& point : line) {
    const char* separator = coordinates.empty() ? "" : ",";
    coordinates += separator + ("[" + point.Text()) + "]";
    times += separator + ("\"" + ToDecimalSeconds(point.time)) + "\"";
  }
  // RFC 7946: a LineString has two positions or more; a Feature may have no geometry.
  const std::string geometry =
      line.size() < 2 ? "null" : R"({"type":"LineString","coordinates":[)" + coordinates + "]}";
  return R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"drive":)" +
         nlohmann::json(drive.name).dump() + R"(,"times_s":[)" + times + R"(]},"geometry":)" +
         geometry + "}]}\n";
}

std::string EncodeTrajectoryKml(const SiteDrive& drive, const SiteDatum& datum,
                                const std::optional<Geoid>& geoid) {
  std::string kml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml "
      "xmlns=\"http://www.opengis.net/kml/2.2\">\n<Placemark>\n<name>" +
      EscapeXml(drive.name) + "</name>\n<description>" + EscapeXml(DescribeHeights(datum, geoid)) +
      "</description>\n<LineString>\n<altitudeMode>" +
      (datum.is_altitude_known ? "absolute" : "clampToGround") + "</altitudeMode>\n<coordinates>\n";
  for (const GlobePoint& point : LineOnGlobe(drive, datum, geoid)) kml += point.Text() + "\n";
  return kml + "</coordinates>\n</LineString>\n</Placemark>\n</kml>\n";
}

}  // namespace parkade

#include "server/pipeline/site_pins.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "core/error.h"
#include "export/trajectory_files.h"
#include "server/map_folder/map_reader.h"

namespace parkade {
namespace {

constexpr double kReach =
    100;  // [m] a pin farther from every drive is in another place, or in another frame
constexpr double kAnchorReach = 30;  // [m] within which a further drive is an anchor
constexpr double kFarFromGnss = 15;  // [m] more than a receiver errs in the open

double NumberFrom(const std::string& text, const std::string& pin) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  Require(!text.empty() && *end == 0 && std::isfinite(number), ErrorCode::kInvalidInput,
          "the pin '" + pin + "' is not [DRIVE:]X,Y,Z=LAT,LON[,HEIGHT]");
  return number;
}

std::vector<double> NumbersFrom(const std::string& list, const std::string& pin) {
  std::vector<double> numbers;
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(',', begin), list.size());
    numbers.push_back(NumberFrom(list.substr(begin, end - begin), pin));
    begin = end + 1;
  }
  return numbers;
}

Trajectory SiteFromImu(const std::vector<TimedPose>& poses) {
  std::vector<TrajectoryState> states(poses.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    states[i].time = poses[i].time;
    states[i].world_from_body = poses[i].world_from_frame;
  }
  return Trajectory(std::move(states));
}

using Trajectories = std::vector<std::pair<std::string, Trajectory>>;  // site_from_imu by drives'
                                                                       // names, in their order

struct NearPose {
  double distance = 0;  ///< [m]
  PinAnchor anchor;
};

NearPose NearestPose(const std::string& drive, const Trajectory& site_from_imu,
                     const Eigen::Vector3d& point_in_site) {
  const auto distance_of = [&](const TrajectoryState& state) {
    return (state.world_from_body.translation - point_in_site).norm();
  };
  const auto& states = site_from_imu.states();
  const auto nearest = std::min_element(
      states.begin(), states.end(),
      [&](const auto& a, const auto& b) { return distance_of(a) < distance_of(b); });
  return {distance_of(*nearest),
          {drive, nearest->time, nearest->world_from_body.Inverse() * point_in_site}};
}

/// Anchors in all drives that pass near, or in the one that is named.
std::vector<PinAnchor> FindAnchors(const AskedPin& pin, const Trajectories& trajectories,
                                   const std::string& name) {
  std::vector<NearPose> near;
  std::string known;
  for (const auto& [drive, trajectory] : trajectories) {
    known += (known.empty() ? "" : ", ") + drive;
    if (!trajectory.empty() && (pin.drive.empty() || pin.drive == drive))
      near.push_back(NearestPose(drive, trajectory, pin.place.point_in_site));
  }
  Require(!near.empty(), ErrorCode::kInvalidInput,
          "the map that " + name + " is set in has no drive '" + pin.drive + "', but: " + known);
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return a.distance < b.distance; });
  Require(near.front().distance <= kReach, ErrorCode::kInvalidInput,
          name + " lies " + std::to_string(std::lround(near.front().distance)) +
              " m from where a drive passed: X,Y,Z are meters in the site of the map that is "
              "started from");
  std::vector<PinAnchor> anchors;
  for (const NearPose& pose : near)
    if (anchors.empty() || pose.distance <= kAnchorReach) anchors.push_back(pose.anchor);
  return anchors;
}

/// Puts the pin where its first anchor in this map has it.
void Locate(const Trajectories& trajectories, SitePin& pin) {
  pin.is_used = false;
  for (const PinAnchor& anchor : pin.anchors) {
    const auto found = std::find_if(trajectories.begin(), trajectories.end(),
                                    [&](const auto& drive) { return drive.first == anchor.drive; });
    if (found == trajectories.end()) continue;
    const std::optional<Rigid3> site_from_imu = found->second.At(anchor.time);
    if (!site_from_imu) continue;
    pin.place.point_in_site = *site_from_imu * anchor.point_in_imu;
    pin.is_used = true;
    return;
  }
}

void AnchorInOtherDrives(const Trajectories& trajectories, SitePin& pin) {
  for (const auto& [drive, trajectory] : trajectories) {
    const bool is_known = std::any_of(pin.anchors.begin(), pin.anchors.end(),
                                      [&](const auto& anchor) { return anchor.drive == drive; });
    if (is_known || trajectory.empty()) continue;
    const NearPose near = NearestPose(drive, trajectory, pin.place.point_in_site);
    if (near.distance <= kAnchorReach) pin.anchors.push_back(near.anchor);
  }
}

void Move(const PinFit& fit, SiteMap& map) {
  for (SiteDrive& drive : map.drives)
    drive.site_from_body_trajectory =
        drive.site_from_body_trajectory.Transformed(fit.pinned_from_site);
  map.datum = fit.datum;
  map.placement = fit.placement;
}

void Warn(const PinOptions& options, SitePinning& pinning) {
  const PinFit& fit = *pinning.fit;
  try {
    RequireAgreement(fit, options);
  } catch (const Error& error) {
    pinning.warnings.push_back(error.what());
  }
  if (!pinning.pinned_from_gnss) return;
  const double offset = pinning.pinned_from_gnss->translation.head<2>().norm();
  if (offset > kFarFromGnss)
    pinning.warnings.push_back("the pins put the site " + std::to_string(std::lround(offset)) +
                               " m from where GNSS has it");
}

}  // namespace

AskedPin ParsePin(const std::string& text) {
  const size_t colon = text.rfind(':'), equals = text.rfind('=');
  const size_t begin = colon == std::string::npos ? 0 : colon + 1;
  Require(equals != std::string::npos && equals >= begin, ErrorCode::kInvalidInput,
          "the pin '" + text + "' is not [DRIVE:]X,Y,Z=LAT,LON[,HEIGHT]");
  const std::vector<double> point = NumbersFrom(text.substr(begin, equals - begin), text);
  const std::vector<double> place = NumbersFrom(text.substr(equals + 1), text);
  Require(point.size() == 3 && (place.size() == 2 || place.size() == 3), ErrorCode::kInvalidInput,
          "the pin '" + text + "' is not [DRIVE:]X,Y,Z=LAT,LON[,HEIGHT]");
  AskedPin pin;
  if (begin > 0) pin.drive = text.substr(0, colon);
  pin.place = {{point[0], point[1], point[2]}, place[0], place[1], std::nullopt};
  if (place.size() == 3) pin.place.height = place[2];
  return pin;
}

std::vector<SitePin> AnchorPins(const std::vector<std::string>& texts,
                                const std::filesystem::path& map, const PinOptions& options) {
  std::vector<AskedPin> asked;
  std::vector<PinnedPoint> places;
  for (const std::string& text : texts) {
    asked.push_back(ParsePin(text));
    places.push_back(asked.back().place);
  }
  RequireAgreement(FitPins(places, options), options);
  const MapReader finished(map);
  Trajectories trajectories;
  for (const std::string& drive : finished.drives())
    trajectories.emplace_back(drive, finished.ReadTrajectory(drive));
  std::vector<SitePin> pins;
  for (size_t i = 0; i < asked.size(); ++i)
    pins.push_back({asked[i].place,
                    FindAnchors(asked[i], trajectories, "pin " + std::to_string(i + 1)), true});
  return pins;
}

SitePinning PinSite(std::vector<SitePin> pins, const PinOptions& options, SiteMap& map) {
  SitePinning pinning;
  pinning.pins = std::move(pins);
  if (pinning.pins.empty()) return pinning;
  Trajectories trajectories;
  for (const SiteDrive& drive : map.drives)
    trajectories.emplace_back(drive.name, SiteFromImu(SampleFinalTrajectory(drive)));
  std::vector<PinnedPoint> used;
  for (SitePin& pin : pinning.pins) {
    Locate(trajectories, pin);
    if (pin.is_used) used.push_back(pin.place);
  }
  try {
    const std::optional<SiteDatum> by_gnss = map.datum;
    pinning.fit =
        FitPins(used, options, by_gnss, map.placement ? map.placement->covariance(3, 3) : 0);
    if (by_gnss) {
      const Rigid3 gnss_site_from_site =
          EarthFromSite(pinning.fit->datum).Inverse() * EarthFromSite(*by_gnss);
      const Eigen::Vector3d center = pinning.fit->placement.center;
      const Rigid3 moved = pinning.fit->pinned_from_site * gnss_site_from_site.Inverse();
      pinning.pinned_from_gnss = Rigid3{moved.rotation, moved * center - center};
    }
  } catch (const Error& error) {
    pinning.warnings.push_back(std::string("the pins are not used: ") + error.what());
    return pinning;
  }
  Move(*pinning.fit, map);
  for (auto& [drive, trajectory] : trajectories)
    trajectory = trajectory.Transformed(pinning.fit->pinned_from_site);
  for (SitePin& pin : pinning.pins) {
    if (!pin.is_used) continue;
    pin.place.point_in_site = pinning.fit->pinned_from_site * pin.place.point_in_site;
    AnchorInOtherDrives(trajectories, pin);
  }
  Warn(options, pinning);
  return pinning;
}

}  // namespace parkade

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/simulator/common/rectangle.h"
#include "tests/simulator/ground/ground.h"

namespace parkade::simulator {

struct SceneOptions {
  std::uint64_t seed = 1;      ///< of the place
  double relief = 1;           ///< scales the slopes of the ground
  double ground_texel = 0.01;  ///< [m] of painted asphalt; larger is quicker to make
  int speed_bumps = 0;         ///< of a lot, at most 4
  int day = 0;                 ///< other parked cars and other light at the same place
  std::string weather = "";  ///< dry, overcast, wet, dusk; empty: as the day wants it, dry on day 0
  std::string looks = "classic";     ///< of what the ground is made (LookOf)
  std::string slot_marks = "usual";  ///< also tees, corners (SlotMarks)
  std::string season = "usual";      ///< of a lot or street; also autumn, winter (Season)
  bool has_drains = false;           ///< grates at kerbs and gutters across the ground
  double sun_elevation = 0;          ///< [degrees]; 0: as the place wants it
  bool has_own_car = true;           ///< false: neither it nor its shadow is to be seen
};

enum class Weather { kDry, kOvercast, kWet, kDusk };

/// The weather that the options ask for. Throws Error{kUsage} for an unknown one.
Weather WeatherOf(const SceneOptions& options);

/// A marked parking space.
struct ParkingSlot {
  Rectangle outline;  ///< x runs from the aisle into the slot
  double height = 0;  ///< [m] of the ground in its middle
  std::string kind = "standard";
  bool is_occupied = false;
  bool is_blocked = false;  ///< by a heap of snow
};

/// What a drive should be like.
struct RouteWish {
  double length = 100;       ///< [m]; the rounds that come closest to it are driven
  bool is_reversed = false;  ///< the other way around
  bool turns_around =
      false;              ///< changes its direction on the way: one place is seen from both sides
  bool is_whole = false;  ///< a round is not cut short, however long it is
  bool ends_in_slot = false;  ///< asks for RoutePlan::slot
  std::uint64_t seed = 1;     ///< of the driver's swings
};

/// A plausible drive through a place.
struct RoutePlan {
  /// x, y and a hint of the height [m]; at least two.
  std::vector<Eigen::Vector3d> waypoints;
  double corner_radius = 6.2;             ///< [m] for Route
  double max_lateral_acceleration = 2.2;  ///< [m/s^2] as people drive there
  /// A free slot beside the last side of the route, for those who end in one:
  /// the car's middle comes to stand in its middle, its nose toward the aisle.
  std::optional<ParkingSlot> slot;
};

/// Where one can drive, without what it looks like: quick to make.
struct Place {
  std::string name;
  Ground ground;
  std::vector<ParkingSlot> slots;
  /// Whether a car may drive on a point of a sheet of `ground`, within its part: neither kerb nor
  /// parked car.
  std::function<bool(size_t sheet, const Eigen::Vector2d&)> is_drivable;
  /// Whether a roof hides the sky from a point of the world: no GNSS there.
  std::function<bool(const Eigen::Vector3d&)> is_covered;
  std::function<RoutePlan(const RouteWish&)> plan_route;
  /// Closed ways [m] of cars on their own lanes and of people on foot, for traffic.
  std::vector<std::vector<Eigen::Vector3d>> lanes, walks;
};

/// A walk from one place to another and back, `apart` [m] beside, `above` the ground.
std::vector<Eigen::Vector3d> WalkAround(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                        double apart, const Ground& ground, double above,
                                        double near_z = 0);

}  // namespace parkade::simulator

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tests/simulator/common/rectangle.h"
#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// A parked car stands on `footprint`, its front along the rectangle's x.
struct ParkedCar {
  Rectangle footprint;
  int style = 0;           ///< 0 hatchback, 1 saloon, 2 van
  std::uint64_t seed = 0;  ///< of its colors and proportions
};

/// What differs from car park to car park.
struct LotMeasures {
  int num_slots = 16;       ///< of the rows along the sides
  double slot_width = 2.5;  ///< [m]
  double slot_depth = 5;    ///< [m]
  double aisle = 6.5;       ///< [m] wide
  double median = 0;        ///< [m] between the two rows in the middle
  double slant = 0;     ///< [rad] by which those in the middle are turned from square to the aisle
  int cross_shift = 0;  ///< slots by which the lane across lies east of the middle
  bool is_turned = false;  ///< the northern aisle is driven first
};

/// The layout of a lot in the open.
LotMeasures MeasureLot(std::uint64_t seed);

/// The plan of a car park: asphalt over [0, length] x [0, width], two aisles
/// along x joined by a lane at each end and one across the middle, four rows of slots.
struct LotLayout {
  double length = 0, width = 0;  ///< [m]
  std::vector<Rectangle> slots;  ///< marked parking spaces, x into the slot
  std::vector<ParkedCar> cars;
  std::vector<Rectangle> islands;  ///< kerbed green
  /// Corners of the two closed round trips, through all of both aisles and through
  /// half of them. They begin with the same stretch of the same aisle.
  std::vector<Eigen::Vector2d> long_loop, short_loop;
  double aisle_y[2] = {0, 0};          ///< [m] center lines
  std::vector<Eigen::Vector2d> bumps;  ///< middles of speed bumps across an aisle
  std::vector<Rectangle> heaps;        ///< of snow, in slots: the ellipses inside

  /// Asphalt that a car may drive on: neither island nor parked car nor heap.
  bool IsDrivable(const Eigen::Vector2d& point) const;

  /// [m] to the next kerb, inside the lot and outside of its islands.
  double FromKerb(const Eigen::Vector2d& point) const;
};

/// [m] that speed bumps raise the ground: 6 cm over a length of 4 m, twice differentiable.
double BumpHeight(const LotLayout& lot, const Eigen::Vector2d& point);

/// Puts speed bumps across the aisles, at most four.
void AddBumps(int count, LotLayout& lot);

/// Shovels snow into free slots, at most `count`; which ones, the day says.
void AddHeaps(int count, std::uint64_t seed, int day, LotLayout& lot);

/// The same seed gives the same plan, but for the parked cars, which change with the day.
LotLayout PlanLot(std::uint64_t seed, int day = 0);
LotLayout PlanLot(const LotMeasures& measures, std::uint64_t seed, int day);
/// The same with the bumps and heaps that the options ask for.
LotLayout PlanLot(const SceneOptions& options);

}  // namespace parkade::simulator

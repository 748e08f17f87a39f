#pragma once

#include <vector>

#include "tests/simulator/motion/drive_path.h"

namespace parkade::simulator {

/// How the driver drives.
struct SpeedOptions {
  double max_speed = 4;                   ///< [m/s]
  double max_reverse_speed = 1.5;         ///< [m/s]
  double max_acceleration = 1.5;          ///< [m/s^2]
  double max_deceleration = 1.8;          ///< [m/s^2]
  double max_lateral_acceleration = 2.2;  ///< [m/s^2]; slows down in curves
  double max_ramp_speed = 3.2;            ///< [m/s] from deck to deck
  double initial_stand = 2;               ///< [s] before the start
  std::vector<double> stops = {
      2.5};  ///< [s] standing in mid-drive, spread evenly over the first leg
  std::vector<double> leg_stands =
      {};                    ///< [s] before the second leg, the third ...; what is not there is 0
  double final_stand = 1;    ///< [s]
  double rolling_speed = 0;  ///< [m/s] the drive begins when this is reached; 0: standing
};

/// The way over time, C2-smooth: forward counts positive, backward negative. Where the direction
/// changes the speed runs smoothly through zero.
class SpeedProfile {
 public:
  /// As fast as the limits allow over the whole path.
  SpeedProfile(const DrivePath& path, const SpeedOptions& options);

  double Duration() const {
    return step_ * static_cast<double>(ways_.size() - 1) - start_;
  }  ///< [s]

  // At `time` [s] from the start; before and after the drive stands.
  double Way(double time) const;           ///< [m] forward minus backward
  double Speed(double time) const;         ///< [m/s], negative when backing up
  double Acceleration(double time) const;  ///< [m/s^2] toward the car's front
  size_t LegAt(double time) const;
  double DistanceInLeg(double time) const;  ///< [m] from the start of LegAt(time)
  double Traveled(double time) const;       ///< [m] forward and backward together, since time 0

 private:
  struct LegSpan {
    double begin_time = 0;  ///< [s] on the clock of ways_
    double begin_way = 0;   ///< [m]
    double length = 0;      ///< [m]
    bool is_reverse = false;
  };
  double DistanceAlong(double time) const;
  double FirstTimeAt(double speed) const;

  double step_ = 0.005;  ///< [s]
  double start_ = 0;     ///< [s] on the clock of ways_ where the drive begins
  std::vector<double> ways_;
  std::vector<LegSpan> legs_;
};

}  // namespace parkade::simulator

#pragma once

#include <vector>

namespace parkade::simulator {

/// What the driver does.
struct DriverOptions {
  double length = 0;                  ///< [m] to drive; 0: what fits the duration
  double max_speed = 6;               ///< [m/s]
  std::vector<double> stops = {2.5};  ///< [s] each, spread evenly over the way
  double initial_stand = 2;           ///< [s] before it goes
  double final_stand = 1;             ///< [s]
  double rolling_start = 0;           ///< [m/s] the log begins at this speed; 0: standing
  bool is_opposite = false;           ///< the round trips the other way around
  bool drives_last_part = false;      ///< of rounds that are longer than `length`, not the first
  bool turns_around = false;          ///< both ways, one after the other
  bool parks = false;                 ///< backs into a slot at the end
  double parked_stand = 5;            ///< [s] in the slot
  bool leaves_slot = false;           ///< and drives out again
  double suspension = 1;              ///< scales how the body leans

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("length", length);
    visit("max_speed", max_speed);
    visit("stops", stops);
    visit("initial_stand", initial_stand);
    visit("final_stand", final_stand);
    visit("rolling_start", rolling_start);
    visit("is_opposite", is_opposite);
    visit("drives_last_part", drives_last_part);
    visit("turns_around", turns_around);
    visit("parks", parks);
    visit("parked_stand", parked_stand);
    visit("leaves_slot", leaves_slot);
    visit("suspension", suspension);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade::simulator

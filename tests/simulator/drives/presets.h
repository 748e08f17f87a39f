#pragma once

#include <string>
#include <vector>

#include "tests/simulator/drives/simulate_drive.h"

namespace parkade::simulator {

/// A drive of the suite.
struct Preset {
  std::string name;
  std::string character;  ///< what is hard about it, in a few words
  SimulateOptions options;
};

/// sim1-4, out0-15 and in0-5 have the lengths and the character of the drives of the paper's suite;
/// pairs and triples of sessions are of one place on several days.
const std::vector<Preset>& Presets();

/// Null for an unknown name.
const Preset* FindPreset(const std::string& name);

/// The same drive in short: a part of the way, short stops, 10 images a second of 640x400. Times of
/// faults shrink with the way.
SimulateOptions QuickForm(const SimulateOptions& options);

}  // namespace parkade::simulator

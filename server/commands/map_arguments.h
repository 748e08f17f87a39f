#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace parkade {

/// What `parkade map` was asked for, as it was typed.
struct MapArguments {
  std::vector<std::string> logs, rigs;
  std::string out, from, preview, work, progress_file, cameras, loops, freespace_model;
  std::vector<std::string> settings, rejected_loops, forced_loops, rejected_links, forced_links,
      pins;
  bool no_pins = false, skips_bad = false;
  bool no_wheel = false, no_gnss = false, no_refine = false, is_odometry_only = false;
  bool print_options = false, explain_options = false, is_quiet = false;
  int num_threads = 0;
  int prepared = 0;  ///< the drive, counted from 1, that alone is prepared; 0: a map is made
};

/// Adds its options to the command; `arguments` outlives it.
void AddMapArguments(CLI::App& command, MapArguments& arguments);

}  // namespace parkade

#include "slam/refinement/drive_refinement.h"

#include <nlohmann/json.hpp>

namespace parkade {

nlohmann::json ToJson(const DriveRefinement& refinement) {
  const auto statistics = [](const AdjustmentStatistics& of) -> nlohmann::json {
    return {{"imu", of.imu},
            {"wheels", of.wheels},
            {"bearings", of.bearings},
            {"loops", of.loops},
            {"gnss", of.gnss},
            {"held_out_loops", of.unused_loops},
            {"held_out_bearings", of.unused_bearings},
            {"num_bearings", of.num_bearings},
            {"num_landmarks", of.num_landmarks}};
  };
  nlohmann::json cameras = nlohmann::json::array();
  for (const CameraRefinement& camera : refinement.cameras)
    cameras.push_back({{"name", camera.name},
                       {"rotation", camera.rotation},
                       {"translation", camera.translation},
                       {"time_offset", camera.time_offset},
                       {"taken", camera.is_taken}});
  return {{"accepted", refinement.is_accepted},
          {"reason", refinement.reason},
          {"before", statistics(refinement.before)},
          {"after", statistics(refinement.after)},
          {"cameras", cameras},
          {"wheel_scale", refinement.wheel_scale},
          {"num_knots", refinement.num_nodes},
          {"num_fixes", refinement.num_fixes},
          {"num_loops", refinement.num_loops},
          {"num_held_out", refinement.num_held_out},
          {"num_pieces", refinement.num_pieces},
          {"num_iterations", refinement.num_iterations},
          {"largest_correction", refinement.largest_correction},
          {"seconds", refinement.seconds}};
}

}  // namespace parkade

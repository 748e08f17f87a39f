#pragma once

#include <string>

#include "core/option_about.h"
#include "mapping/ground/ground_grid.h"
#include "mapping/observation/estimate_ground_plane.h"
#include "mapping/observation/segment_ground.h"

namespace parkade {

/// Which images of a drive are looked at, and what is taken for ground in them.
struct GroundOptions {
  double keyframe_distance =
      1.2;  ///< [m] of travel between images used of one camera; less is slower, denser
  double keyframe_angle_deg = 10.0;  ///< or this much turning
  int passes = 2;  ///< of one place in one direction whose images are looked at; 0: of all
  bool use_semantics =
      true;  ///< masks of the log (`<camera>/semantic`) go before what we find ourselves
  std::string method =
      "network";  ///< "network" finds drivable ground, or "colors" and geometry guess it
  std::string freespace_model;  ///< ONNX file, see FreespaceNetwork; empty: Parkade's own networks
  bool level_views = true;  ///< our own network sees wide lenses' images as LevelView shows them
  GroundGridOptions grid;
  SegmentGroundOptions segmentation;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("passes", passes,
          OptionAbout{"Where a drive comes by again and again in one direction, images of so many "
                      "passes are looked at; 0: of all.",
                      "", 0, 1000});
    visit("use_semantics", use_semantics, OptionAbout{"Masks of the log replace the network's."});
    visit("method", method,
          OptionAbout{"Drivable ground is found by the network (\"network\") or by its colors "
                      "(\"colors\")."});
    visit("freespace_model", freespace_model,
          OptionAbout{"This ONNX file is the network; empty: the built-in one."});
    visit("level_views", level_views,
          OptionAbout{
              "The network looks at views that are turned level where the camera is calibrated."});
    visit("grid", grid);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade

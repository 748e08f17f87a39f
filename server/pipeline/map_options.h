#pragma once

#include "mapping/markings/find_markings.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/surface/fuse_surface.h"
#include "mapping/texture/paint_texture.h"
#include "slam/georeference/align_to_gnss.h"
#include "slam/georeference/fit_pins.h"
#include "slam/loops/close_loops.h"
#include "slam/odometry/estimate_trajectory.h"
#include "slam/refinement/refinement_options.h"
#include "slam/sessions/session_loops.h"

namespace parkade {

/// Everything that can be set about a map, stage by stage: `--set odometry.max_iterations=6`.
struct MapOptions {
  OdometryOptions odometry;
  LoopOptions loops;
  RefinementOptions refinement;
  SessionLoopOptions links;
  GnssAlignOptions gnss;
  PinOptions pins;
  GroundOptions ground;
  SurfaceOptions surface;
  MeshOptions mesh;
  TextureOptions texture;
  MarkingOptions markings;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("odometry", odometry);
    visit("loops", loops);
    visit("refinement", refinement);
    visit("links", links);
    visit("gnss", gnss);
    visit("pins", pins);
    visit("ground", ground);
    visit("mapping", surface);
    visit("mesh", mesh);
    visit("texture", texture);
    visit("markings", markings);
  }
};

}  // namespace parkade

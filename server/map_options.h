#pragma once

#include "mapping/find_markings.h"
#include "mapping/fuse_surface.h"
#include "mapping/mesh_surface.h"
#include "mapping/observe_ground.h"
#include "mapping/paint_texture.h"
#include "slam/align_to_gnss.h"
#include "slam/close_loops.h"
#include "slam/cut_into_submaps.h"
#include "slam/drive_links.h"
#include "slam/estimate_trajectory.h"
#include "slam/fit_pins.h"
#include "slam/refinement_options.h"

namespace parkade {

/// Everything that can be set about a map, stage by stage: `--set odometry.max_iterations=6`.
struct MapOptions {
  OdometryOptions odometry;
  LoopOptions loops;
  RefinementOptions refinement;
  DriveLinkOptions links;
  SubmapOptions submaps;
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
    visit("submaps", submaps);
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

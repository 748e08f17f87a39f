#pragma once

#include <span>
#include <string>

#include "core/surface_map.h"
#include "mapping/drive_heights.h"
#include "mapping/driven_path.h"
#include "mapping/fuse_voxels.h"
#include "mapping/height_field.h"
#include "mapping/measure_heights.h"
#include "mapping/patch_source.h"

namespace parkade {

struct SurfaceOptions {
  std::string method = "surface";    ///< or "homography": flat ground in voxels, as in the seed paper, to compare
  std::string outlines = "network";  ///< corrects those that all sights together draw; or "sights" alone
  double cell_size = 0.05;           ///< [m] of colours and free space; height.spacing must be a multiple
  double contact_sigma = 0.01;       ///< [m] of the road's height at a wheel
  double suspension_sigma = 0.005;   ///< [rad] of the body's pitch: adds to the front wheels
  double plane_share = 0.1;          ///< weight of a square of a keyframe's plane: those around it err alike
  double free_log_odds = 0.8;        ///< of one sight of free ground near the car; less with distance
  double occupied_log_odds = 0.8;    ///< of one sight of something else; more keeps obstacles, and their halo, out
  double log_odds_limit = 8.0;       ///< of one drive
  double change_log_odds = 0.1;      ///< from which a drive that contradicts those before it is believed alone
  double max_height_sigma = 0.12;    ///< [m] ground whose height is known less well is not mapped
  double min_island_area = 200.0;    ///< [m^2] smaller free islands that no car drove on are most often walls
  int latest_drives = 6;             ///< so many of the latest that looked at a place say what it looks like
  double tile_size = 48.0;           ///< [m] of the squares painted two at a time; less takes less memory
  HeightFieldOptions height;
  MeasureHeightsOptions sweep;
  VoxelFusionOptions voxels;  ///< of the method "homography"

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("method", method);
    visit("outlines", outlines);
    visit("cell_size", cell_size);
    visit("contact_sigma", contact_sigma);
    visit("suspension_sigma", suspension_sigma);
    visit("plane_share", plane_share);
    visit("free_log_odds", free_log_odds);
    visit("occupied_log_odds", occupied_log_odds);
    visit("log_odds_limit", log_odds_limit);
    visit("change_log_odds", change_log_odds);
    visit("max_height_sigma", max_height_sigma);
    visit("min_island_area", min_island_area);
    visit("latest_drives", latest_drives);
    visit("tile_size", tile_size);
    visit("height", height);
    visit("sweep", sweep);
    visit("voxels", voxels);
  }
  void Validate() const;  ///< throws Error{kUsage}
  HeightOptions Heights() const { return {contact_sigma, suspension_sigma, plane_share, height, sweep}; }
};

/// The ground of a site from all its drives.
///
/// 1. Heights: wheel contacts (the surest); beside the path what many views of a drive agree on; and, weakly and weaker
///    with distance, the planes on which keyframes saw ground. A HeightField is fitted to what all drives know
///    (FitHeights).
/// 2. Colour and free space: every sample moves along its ray of sight onto that surface, so that a ramp ahead is
///    painted where it is, and not where the car's own plane would have it. Free space is a log-odds sum, bounded; of a
///    drive that contradicts those before it nothing else counts there, and at most `latest_drives` that looked at a
///    place do (see LatestDrives); a cell's colour is the median of its nearest sights; what a car drove over is free,
///    until a later drive sees otherwise.
/// 3. The free space is corrected from above (OutlineNetwork).
/// 4. Pinholes are filled, islands that no car drove on and that are small are dropped.
///
/// 2 to 4 go square by square of `tile_size`: in memory are the patches and the evidence of two squares, and the
/// cells of all. The result does not depend on the squares, but for rounding in 3 and for specks of a deck that it
/// leaves out. With the method "homography" FuseVoxels is asked instead. `heights` are those of MeasureDriveHeights, of
/// all drives; `measured` are heights that something else knows. Cells that nothing was seen of are not in the map. The
/// patches of a drive without a path are painted where their own plane says. Same input, same output, whatever the
/// number of threads. O(samples).
SurfaceMap FuseSurface(const PatchSource& patches, std::span<const DrivenPath> paths,
                       std::span<const DriveHeights> heights, const SurfaceOptions& options = {},
                       std::span<const HeightObservation> measured = {});

/// Likewise of patches in memory, whose heights are measured first.
SurfaceMap FuseSurface(std::span<const PosedGroundPatch> patches, std::span<const DrivenPath> paths,
                       const SurfaceOptions& options = {}, std::span<const HeightObservation> measured = {});

}  // namespace parkade

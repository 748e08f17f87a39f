#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "core/ground_texture.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/markings/merge_slots.h"
#include "mapping/markings/paint_areas.h"
#include "mapping/markings/paint_lines.h"
#include "mapping/markings/slot_row_options.h"

namespace parkade {

/// What the ground of a site is made of for this stage. All borrowed but for `known`.
struct MarkedGround {
  const TriangleMesh& mesh;
  const SurfaceMap& surface;
  const GroundTexture& texture;
  const PatchSource& patches;
  std::span<const DrivenPath> paths;
  std::size_t num_drives = 0;
  std::vector<SlotLook> known = {};  ///< slots of looks before this one, see MatchLooks
};

/// The paint of a site, on its surface.
struct Paint {
  std::vector<PaintLine> lines;
  std::vector<PaintArea> areas;
};

/// Lines and areas, deck by deck and tile by tile. In parallel, the same every time.
Paint FindPaint(const MarkedGround& ground, const PaintLineOptions& options = {});

/// The slots of a site with what each drive saw in them.
///
/// Rows of lines are slots (FindSlotRows), unless a car drove through them. Those of
/// MarkedGround::known stay unless the texture, which shows what the latest drive saw, contradicts
/// them (SeeSides, ChooseSlots). Slots that no look named have no id.
std::vector<ParkingSlot> FindSlots(const MarkedGround& ground, const Paint& paint,
                                   const SlotRowOptions& options = {});

}  // namespace parkade

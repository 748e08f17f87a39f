#pragma once

#include <span>

#include "core/ground_markings.h"
#include "core/ground_texture.h"
#include "core/option_about.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"
#include "mapping/markings/find_kerbs.h"
#include "mapping/markings/find_speed_bumps.h"
#include "mapping/markings/paint_areas.h"
#include "mapping/markings/paint_lines.h"
#include "mapping/markings/slot_rows.h"
#include "mapping/markings/slot_states.h"

namespace parkade {

struct MarkingOptions {
  bool enabled = true;  ///< needs the texture
  PaintLineOptions lines;
  SlotRowOptions slots;
  KerbOptions kerbs;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("enabled", enabled,
          OptionAbout{"Markings, slots, kerbs and speed bumps are looked for."});
    visit("slots", slots);
    visit("kerbs", kerbs);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// What the ground of a site is made of for this stage. All borrowed.
struct MarkedGround {
  const TriangleMesh& mesh;
  const SurfaceMap& surface;
  const GroundTexture& texture;
  const PatchSource& patches;
  std::span<const DrivenPath> paths;
  std::size_t num_drives = 0;
};

/// Parking slots with what each drive saw in them, other paint, speed bumps, and kerbs.
///
/// Deck by deck, tile by tile, lines and areas of paint are found in the texture (FindPaintLines,
/// FindPaintAreas); rows of lines are slots (FindSlotRows); samples of the ground say who stood in
/// them (SeeSlots); the heights that the wheels drove over say where bumps are (FindSpeedBumps);
/// what is seen beyond the outline says where kerbs are (FindKerbs). Without a texture there are
/// bumps and kerbs only. In parallel over tiles, the same every time.
GroundMarkings FindMarkings(const MarkedGround& ground, const MarkingOptions& options = {});

}  // namespace parkade

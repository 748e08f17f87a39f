#pragma once

#include <cstddef>

#include "core/option_about.h"
#include "slam/places/relative_pose.h"

namespace parkade {

/// A keyframe of one drive at the place of a keyframe of another.
struct SessionLoop {
  size_t keyframe_a = 0, keyframe_b = 0;  ///< indices
  double score = 0;   ///< by place recognition; 0 where the link was foretold by others
  RelativePose pose;  ///< of keyframe b in keyframe a
};

struct SessionLoopOptions {
  int max_candidates = 3;  ///< per keyframe, the most alike keyframes of the other drive
  int batch = 24;          ///< candidates measured at a time, the most alike first
  int max_measured = 480;  ///< without a drive that fits: then it does not
  int min_links = 6;       ///< that agree with each other ...
  double min_spread = 6;   ///< [m] ... and lie this far apart
  double max_rival_share =
      0.6;  ///< of links that agree on something else, relative to the best: more is ambiguous
  int neighbors = 1;  ///< keyframes before and after one that are measured with it
  double reach = 4;   ///< [m] around its foretold position in which a keyframe is looked for
  double height_reach =
      1.2;  ///< [m] the same for heights; decks of a garage lie 2.5 m apart or more
  // Two links agree where the ways between their ends in both drives close with them, up to these.
  double closing_base = 0.15;       ///< [m], plus ...
  double closing_per_meter = 0.01;  ///< ... this share of the ways
  double closing_deg = 1.0;         ///< plus 0.02 degrees per meter
  // Drives whose keyframes look alike must also share the floor, if their floors show enough to
  // tell.
  int min_floor_tiles = 12;  ///< compared, in both drives and between them; fewer tell nothing
  double telling_floor =
      0.3;  ///< share of a drive's tiles that fit its own next keyframe; less in both tells nothing
  double min_floor_share =
      0.5;  ///< of the share that fits within the drives, must fit between them
  int all_pairs_up_to =
      6;  ///< drives; if there are more, not every pair is linked, but each drive with ...
  int partners = 3;  ///< ... these many that look most like it, and more where drives stay apart

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("min_links", min_links,
          OptionAbout{"Two drives need this many loops between them that agree.", "", 2, 100});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade

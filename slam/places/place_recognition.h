#pragma once

#include <functional>
#include <vector>

#include "core/option_about.h"
#include "slam/places/place_words.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

struct RecognitionOptions {
  double min_gap = 25;            ///< [m] driven between two visits
  double drift_base = 4;          ///< [m] two visits may seem apart, plus ...
  double drift_per_meter = 0.03;  ///< ... this share of the way between them
  double height_base =
      0.7;  ///< [m] the same for heights: decks of a garage lie 2.5 m apart or more
  double height_per_meter = 0.005;
  int max_candidates = 5;  ///< per keyframe, the most alike first

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("max_candidates", max_candidates,
          OptionAbout{"Each keyframe is compared with this many that look like it.", "", 1, 50});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Two keyframes that may show one place.
struct PlaceCandidate {
  size_t earlier = 0, later = 0;  ///< indices of keyframes
  double score = 0;               ///< 0 to 1, cosine of their words
};

/// Keyframes that odometry allows to be at the place of another, and two neighbors to each side of
/// them, from whose images their points come. One flag per keyframe.
std::vector<bool> FindPossibleRevisits(const std::vector<RigKeyframe>& keyframes,
                                       const RecognitionOptions& options);

/// Earlier keyframes that look like later ones, among the pairs (earlier, later) that are possible.
/// Inverted index, tf-idf (J. Sivic, A. Zisserman, "Video Google", ICCV 2003). In order of `later`,
/// then of score, at most `max_candidates` of each. O(keyframes that share a word, summed over
/// words).
std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& keyframes,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates);

/// The same for two drives: `earlier` and `later` of a candidate are indices into either's
/// keyframes.
std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& earlier, const PlaceWords& later,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates);

/// Pairs of alike keyframes of one drive that its odometry does not rule out. Of the keyframes
/// only their places are looked at.
std::vector<PlaceCandidate> RecognizePlaces(const PlaceWords& words,
                                            const std::vector<RigKeyframe>& keyframes,
                                            const RecognitionOptions& options);

}  // namespace parkade

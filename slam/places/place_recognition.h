#pragma once

#include <functional>
#include <vector>

#include "slam/places/place.h"
#include "slam/places/place_words.h"

namespace parkade {

struct RecognitionOptions {
  double min_gap = 25;            ///< [m] driven between two visits
  double drift_base = 4;          ///< [m] two visits may seem apart, plus ...
  double drift_per_metre = 0.03;  ///< ... this share of the way between them
  double height_base = 0.7;       ///< [m] the same for heights: decks of a garage lie 2.5 m apart or more
  double height_per_metre = 0.005;
  int max_candidates = 5;  ///< per place, the most alike first

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("min_gap", min_gap);
    visit("drift_base", drift_base);
    visit("drift_per_metre", drift_per_metre);
    visit("height_base", height_base);
    visit("height_per_metre", height_per_metre);
    visit("max_candidates", max_candidates);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Two places that may be one.
struct PlaceCandidate {
  size_t earlier = 0, later = 0;  ///< indices of places
  double score = 0;               ///< 0 to 1, cosine of their words
};

/// Places that odometry allows to be one with another, and two neighbours to each side of them, from whose images
/// their points come. One flag per place.
std::vector<bool> FindPossibleRevisits(const std::vector<Place>& places, const RecognitionOptions& options);

/// Earlier places that look like later ones, among the pairs (earlier, later) that are possible. Inverted index, tf-idf
/// (J. Sivic, A. Zisserman, "Video Google", ICCV 2003). In order of `later`, then of score, at most `max_candidates` of
/// each. O(places that share a word, summed over words).
std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& places,
                                            const std::function<bool(size_t, size_t)>& is_possible, int max_candidates);

/// Likewise of two drives: `earlier` and `later` of a candidate are indices into either's places.
std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& earlier, const PlaceWords& later,
                                            const std::function<bool(size_t, size_t)>& is_possible, int max_candidates);

/// Alike places of one drive that its odometry does not rule out.
std::vector<PlaceCandidate> RecognisePlaces(const std::vector<Place>& places, const RecognitionOptions& options);

}  // namespace parkade

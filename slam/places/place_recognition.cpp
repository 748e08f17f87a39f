#include "slam/places/place_recognition.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/error.h"

namespace parkade {
namespace {

/// Which places have each word.
class WordIndex {
 public:
  /// \param entries  of all places, sorted, each once
  WordIndex(const std::vector<PlaceWords::Entry>& entries, size_t num_places)
      : words_of_(num_places), norms_(num_places) {
    places_.reserve(entries.size());
    for (size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
      while (end < entries.size() && entries[end].word == entries[begin].word) ++end;
      const double inverse_frequency = std::log(static_cast<double>(num_places) / static_cast<double>(end - begin));
      const double weight = inverse_frequency * inverse_frequency;
      for (size_t i = begin; i < end; ++i) {
        places_.push_back(entries[i].place);
        words_of_[entries[i].place].push_back(words_.size());
        norms_[entries[i].place] += weight;
      }
      words_.push_back({begin, weight});
    }
    for (double& norm : norms_) norm = std::sqrt(norm);
  }

  /// Cosines of the words of `later` with those of each of the first places, up to `end`.
  void ScoreThoseBefore(size_t end, size_t later, std::vector<double>& scores) const {
    std::fill(scores.begin(), scores.end(), 0);
    for (const size_t word : words_of_[later])
      for (size_t i = words_[word].begin; places_[i] < end; ++i) scores[places_[i]] += words_[word].weight;
    for (size_t i = 0; i < end; ++i)
      if (scores[i] > 0) scores[i] /= norms_[i] * norms_[later];
  }

 private:
  struct Word {
    size_t begin = 0;   ///< in places_
    double weight = 0;  ///< tf-idf, squared
  };
  std::vector<Word> words_;
  std::vector<std::uint32_t> places_;          ///< word by word, ascending
  std::vector<std::vector<size_t>> words_of_;  ///< per place, ascending
  std::vector<double> norms_;                  ///< per place
};

/// What looks most like each of the places from `first_later` on, of those before it and before `end_earlier`.
std::vector<PlaceCandidate> FindAlike(const WordIndex& index, size_t num_places, size_t first_later, size_t end_earlier,
                                      const std::function<bool(size_t, size_t)>& is_possible, int max_candidates) {
  std::vector<PlaceCandidate> candidates;
  std::vector<double> scores(num_places);
  for (size_t later = first_later; later < num_places; ++later) {
    const size_t end = std::min(later, end_earlier);
    index.ScoreThoseBefore(end, later, scores);
    std::vector<PlaceCandidate> found;
    for (size_t earlier = 0; earlier < end; ++earlier)
      if (scores[earlier] > 0 && is_possible(earlier, later)) found.push_back({earlier, later, scores[earlier]});
    std::stable_sort(found.begin(), found.end(),
                     [](const PlaceCandidate& a, const PlaceCandidate& b) { return a.score > b.score; });
    found.resize(std::min(found.size(), static_cast<size_t>(max_candidates)));
    candidates.insert(candidates.end(), found.begin(), found.end());
  }
  return candidates;
}

bool IsPossible(const Place& earlier, const Place& later, const RecognitionOptions& options) {
  const double way = later.distance - earlier.distance;
  if (way < options.min_gap) return false;
  const Eigen::Vector3d apart = later.odom_from_place.translation - earlier.odom_from_place.translation;
  return apart.head<2>().norm() < options.drift_base + options.drift_per_metre * way &&
         std::abs(apart.z()) < options.height_base + options.height_per_metre * way;
}

}  // namespace

void RecognitionOptions::Validate() const {
  Require(min_gap > 0 && drift_base >= 0 && drift_per_metre >= 0 && height_base >= 0 && height_per_metre >= 0,
          ErrorCode::kUsage, "the options of place recognition must not be negative");
  Require(max_candidates > 0, ErrorCode::kUsage, "max_candidates of place recognition must be positive");
}

std::vector<bool> FindPossibleRevisits(const std::vector<Place>& places, const RecognitionOptions& options) {
  constexpr size_t kNeighbours = 2;
  std::vector<bool> is_possible(places.size());
  const auto mark = [&](size_t index) {
    const size_t last = std::min(index + kNeighbours, places.size() - 1);
    for (size_t i = index - std::min(index, kNeighbours); i <= last; ++i) is_possible[i] = true;
  };
  for (size_t later = 0; later < places.size(); ++later) {
    for (size_t earlier = 0; earlier < later; ++earlier) {
      if (!IsPossible(places[earlier], places[later], options)) continue;
      mark(earlier);
      mark(later);
    }
  }
  return is_possible;
}

std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& places,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates) {
  const size_t count = places.num_places();
  return FindAlike(WordIndex(places.entries(), count), count, 0, count, is_possible, max_candidates);
}

std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& earlier, const PlaceWords& later,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates) {
  const size_t num_earlier = earlier.num_places(), count = num_earlier + later.num_places();
  std::vector<PlaceWords::Entry> of_later = later.entries(), all;
  for (PlaceWords::Entry& entry : of_later) entry.place += static_cast<std::uint32_t>(num_earlier);
  all.reserve(earlier.entries().size() + of_later.size());
  std::merge(earlier.entries().begin(), earlier.entries().end(), of_later.begin(), of_later.end(),
             std::back_inserter(all));
  const auto is_possible_pair = [&](size_t a, size_t b) { return is_possible(a, b - num_earlier); };
  std::vector<PlaceCandidate> candidates =
      FindAlike(WordIndex(all, count), count, num_earlier, num_earlier, is_possible_pair, max_candidates);
  for (PlaceCandidate& candidate : candidates) candidate.later -= num_earlier;
  return candidates;
}

std::vector<PlaceCandidate> RecognisePlaces(const std::vector<Place>& places, const RecognitionOptions& options) {
  options.Validate();
  return FindAlikePlaces(
      PlaceWords(places),
      [&](size_t earlier, size_t later) { return IsPossible(places[earlier], places[later], options); },
      options.max_candidates);
}

}  // namespace parkade

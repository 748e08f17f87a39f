#include "slam/places/place_recognition.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/error.h"

namespace parkade {
namespace {

/// Which keyframes have each word.
class WordIndex {
 public:
  /// \param entries  of all keyframes, sorted, each once
  WordIndex(const std::vector<PlaceWords::Entry>& entries, size_t num_keyframes)
      : words_of_(num_keyframes), norms_(num_keyframes) {
    keyframes_.reserve(entries.size());
    for (size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
      while (end < entries.size() && entries[end].word == entries[begin].word) ++end;
      const double inverse_frequency =
          std::log(static_cast<double>(num_keyframes) / static_cast<double>(end - begin));
      const double weight = inverse_frequency * inverse_frequency;
      for (size_t i = begin; i < end; ++i) {
        keyframes_.push_back(entries[i].keyframe);
        words_of_[entries[i].keyframe].push_back(words_.size());
        norms_[entries[i].keyframe] += weight;
      }
      words_.push_back({begin, weight});
    }
    for (double& norm : norms_) norm = std::sqrt(norm);
  }

  /// Cosines between the words of `later` and of each keyframe below `end`.
  void ScoreThoseBefore(size_t end, size_t later, std::vector<double>& scores) const {
    std::fill(scores.begin(), scores.end(), 0);
    for (const size_t word : words_of_[later])
      for (size_t i = words_[word].begin; keyframes_[i] < end; ++i)
        scores[keyframes_[i]] += words_[word].weight;
    for (size_t i = 0; i < end; ++i)
      if (scores[i] > 0) scores[i] /= norms_[i] * norms_[later];
  }

 private:
  struct Word {
    size_t begin = 0;   ///< in keyframes_
    double weight = 0;  ///< tf-idf, squared
  };
  std::vector<Word> words_;
  std::vector<std::uint32_t> keyframes_;       ///< word by word, ascending
  std::vector<std::vector<size_t>> words_of_;  ///< per keyframe, ascending
  std::vector<double> norms_;                  ///< per keyframe
};

/// For each keyframe from `first_later` on, the most alike keyframes before it and before
/// `end_earlier`.
std::vector<PlaceCandidate> FindAlike(const WordIndex& index, size_t num_keyframes,
                                      size_t first_later, size_t end_earlier,
                                      const std::function<bool(size_t, size_t)>& is_possible,
                                      int max_candidates) {
  std::vector<PlaceCandidate> candidates;
  std::vector<double> scores(num_keyframes);
  for (size_t later = first_later; later < num_keyframes; ++later) {
    const size_t end = std::min(later, end_earlier);
    index.ScoreThoseBefore(end, later, scores);
    std::vector<PlaceCandidate> found;
    for (size_t earlier = 0; earlier < end; ++earlier)
      if (scores[earlier] > 0 && is_possible(earlier, later))
        found.push_back({earlier, later, scores[earlier]});
    std::stable_sort(
        found.begin(), found.end(),
        [](const PlaceCandidate& a, const PlaceCandidate& b) { return a.score > b.score; });
    found.resize(std::min(found.size(), static_cast<size_t>(max_candidates)));
    candidates.insert(candidates.end(), found.begin(), found.end());
  }
  return candidates;
}

bool IsPossible(const RigKeyframe& earlier, const RigKeyframe& later,
                const RecognitionOptions& options) {
  const double way = later.distance - earlier.distance;
  if (way < options.min_gap) return false;
  const Eigen::Vector3d apart =
      later.odom_from_keyframe.translation - earlier.odom_from_keyframe.translation;
  return apart.head<2>().norm() < options.drift_base + options.drift_per_meter * way &&
         std::abs(apart.z()) < options.height_base + options.height_per_meter * way;
}

}  // namespace

void RecognitionOptions::Validate() const {
  Require(min_gap > 0 && drift_base >= 0 && drift_per_meter >= 0 && height_base >= 0 &&
              height_per_meter >= 0,
          ErrorCode::kUsage, "the options of place recognition must not be negative");
  Require(max_candidates > 0, ErrorCode::kUsage,
          "max_candidates of place recognition must be positive");
}

std::vector<bool> FindPossibleRevisits(const std::vector<RigKeyframe>& keyframes,
                                       const RecognitionOptions& options) {
  constexpr size_t kNeighbors = 2;
  std::vector<bool> is_possible(keyframes.size());
  const auto mark = [&](size_t index) {
    const size_t last = std::min(index + kNeighbors, keyframes.size() - 1);
    for (size_t i = index - std::min(index, kNeighbors); i <= last; ++i) is_possible[i] = true;
  };
  for (size_t later = 0; later < keyframes.size(); ++later) {
    for (size_t earlier = 0; earlier < later; ++earlier) {
      if (!IsPossible(keyframes[earlier], keyframes[later], options)) continue;
      mark(earlier);
      mark(later);
    }
  }
  return is_possible;
}

std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& keyframes,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates) {
  const size_t count = keyframes.num_keyframes();
  return FindAlike(WordIndex(keyframes.entries(), count), count, 0, count, is_possible,
                   max_candidates);
}

std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& earlier, const PlaceWords& later,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates) {
  const size_t num_earlier = earlier.num_keyframes(), count = num_earlier + later.num_keyframes();
  std::vector<PlaceWords::Entry> of_later = later.entries(), all;
  for (PlaceWords::Entry& entry : of_later)
    entry.keyframe += static_cast<std::uint32_t>(num_earlier);
  all.reserve(earlier.entries().size() + of_later.size());
  std::merge(earlier.entries().begin(), earlier.entries().end(), of_later.begin(), of_later.end(),
             std::back_inserter(all));
  const auto is_possible_pair = [&](size_t a, size_t b) { return is_possible(a, b - num_earlier); };
  std::vector<PlaceCandidate> candidates = FindAlike(WordIndex(all, count), count, num_earlier,
                                                     num_earlier, is_possible_pair, max_candidates);
  for (PlaceCandidate& candidate : candidates) candidate.later -= num_earlier;
  return candidates;
}

std::vector<PlaceCandidate> RecognizePlaces(const std::vector<RigKeyframe>& keyframes,
                                            const RecognitionOptions& options) {
  options.Validate();
  return FindAlikePlaces(
      PlaceWords(keyframes),
      [&](size_t earlier, size_t later) {
        return IsPossible(keyframes[earlier], keyframes[later], options);
      },
      options.max_candidates);
}

}  // namespace parkade

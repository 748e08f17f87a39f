#include "slam/places/place_recognition.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

/// The words of keyframes. Borrowed.
using WordsOfKeyframes = std::vector<const std::vector<std::uint32_t>*>;

/// Which keyframes have each word.
class WordIndex {
 public:
  explicit WordIndex(WordsOfKeyframes words)
      : words_of_(std::move(words)),
        begins_(PlaceWords::kNumWords + 1),
        weights_(PlaceWords::kNumWords),
        norms_(words_of_.size()) {
    for (const auto* words_of_one : words_of_)
      for (const std::uint32_t word : *words_of_one) ++begins_[word + 1];
    for (std::size_t word = 0; word < weights_.size(); ++word) {
      if (begins_[word + 1] == 0) continue;
      const double inverse_frequency =
          std::log(static_cast<double>(words_of_.size()) / static_cast<double>(begins_[word + 1]));
      weights_[word] = inverse_frequency * inverse_frequency;
    }
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    keyframes_.resize(begins_.back());
    std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
    for (std::size_t i = 0; i < words_of_.size(); ++i) {
      for (const std::uint32_t word : *words_of_[i]) {
        keyframes_[next[word]++] = static_cast<std::uint32_t>(i);
        norms_[i] += weights_[word];
      }
      norms_[i] = std::sqrt(norms_[i]);
    }
  }

  std::size_t num_keyframes() const { return words_of_.size(); }

  /// Cosines between the words of `later` and of each keyframe below `end`.
  void ScoreThoseBefore(std::size_t end, std::size_t later, std::vector<double>& scores) const {
    std::fill(scores.begin(), scores.end(), 0);
    for (const std::uint32_t word : *words_of_[later])
      for (std::size_t i = begins_[word]; keyframes_[i] < end; ++i)
        scores[keyframes_[i]] += weights_[word];
    for (std::size_t i = 0; i < end; ++i)
      if (scores[i] > 0) scores[i] /= norms_[i] * norms_[later];
  }

 private:
  WordsOfKeyframes words_of_;
  std::vector<std::size_t> begins_;       ///< by word, in keyframes_; and the end
  std::vector<double> weights_;           ///< by word: tf-idf, squared
  std::vector<std::uint32_t> keyframes_;  ///< word by word, ascending
  std::vector<double> norms_;             ///< per keyframe
};

void AddWords(const PlaceWords& drive, WordsOfKeyframes& words) {
  for (const std::vector<std::uint32_t>& of_keyframe : drive.of_keyframes())
    words.push_back(&of_keyframe);
}

/// For each keyframe from `first_later` on, the most alike keyframes before it and before
/// `end_earlier`.
std::vector<PlaceCandidate> FindAlike(const WordIndex& index, size_t first_later,
                                      size_t end_earlier,
                                      const std::function<bool(size_t, size_t)>& is_possible,
                                      int max_candidates) {
  std::vector<PlaceCandidate> candidates;
  std::vector<double> scores(index.num_keyframes());
  for (size_t later = first_later; later < index.num_keyframes(); ++later) {
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
  WordsOfKeyframes words;
  AddWords(keyframes, words);
  const size_t count = words.size();
  return FindAlike(WordIndex(std::move(words)), 0, count, is_possible, max_candidates);
}

std::vector<PlaceCandidate> FindAlikePlaces(const PlaceWords& earlier, const PlaceWords& later,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates) {
  WordsOfKeyframes words;
  AddWords(earlier, words);
  const size_t num_earlier = words.size();
  AddWords(later, words);
  const auto is_possible_pair = [&](size_t a, size_t b) { return is_possible(a, b - num_earlier); };
  std::vector<PlaceCandidate> candidates = FindAlike(WordIndex(std::move(words)), num_earlier,
                                                     num_earlier, is_possible_pair, max_candidates);
  for (PlaceCandidate& candidate : candidates) candidate.later -= num_earlier;
  return candidates;
}

std::vector<PlaceCandidate> RecognizePlaces(const PlaceWords& words,
                                            const std::vector<RigKeyframe>& keyframes,
                                            const RecognitionOptions& options) {
  options.Validate();
  return FindAlikePlaces(
      words,
      [&](size_t earlier, size_t later) {
        return IsPossible(keyframes[earlier], keyframes[later], options);
      },
      options.max_candidates);
}

}  // namespace parkade

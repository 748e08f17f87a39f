#include "slam/place_recognition.h"

#include <unordered_map>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kTables = 4;
constexpr int kBits = 16;

/// Positions of bits in a descriptor that make up the words: a fixed shuffle.
std::array<int, kTables * kBits> ChooseBits() {
  std::array<int, 256> bits{};
  for (int i = 0; i < 256; ++i) bits[static_cast<size_t>(i)] = i;
  std::uint32_t random = 12345;
  for (size_t i = 255; i > 0; --i) {
    random = random * 1664525u + 1013904223u;
    std::swap(bits[i], bits[(random >> 8) % (i + 1)]);
  }
  std::array<int, kTables * kBits> chosen{};
  std::copy_n(bits.begin(), chosen.size(), chosen.begin());
  return chosen;
}

/// The words of a place, sorted, each once.
std::vector<std::uint32_t> WordsOf(const Place& place) {
  static const std::array<int, kTables* kBits> kChosen = ChooseBits();
  std::vector<std::uint32_t> words;
  for (int row = 0; row < place.descriptors.rows; ++row) {
    const uchar* descriptor = place.descriptors.ptr(row);
    for (int table = 0; table < kTables; ++table) {
      std::uint32_t word = static_cast<std::uint32_t>(table);
      for (int i = 0; i < kBits; ++i) {
        const int bit = kChosen[static_cast<size_t>(table * kBits + i)];
        word = 2 * word + ((descriptor[bit / 8] >> (bit % 8)) & 1u);
      }
      words.push_back(word);
    }
  }
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
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

std::vector<PlaceCandidate> FindAlikePlaces(const std::vector<const Place*>& places,
                                            const std::function<bool(size_t, size_t)>& is_possible,
                                            int max_candidates) {
  std::vector<std::vector<std::uint32_t>> words;
  std::unordered_map<std::uint32_t, std::vector<size_t>> places_with;
  for (size_t i = 0; i < places.size(); ++i) {
    words.push_back(WordsOf(*places[i]));
    for (const std::uint32_t word : words.back()) places_with[word].push_back(i);
  }
  const auto inverse_frequency = [&](size_t count) {
    return std::log(static_cast<double>(places.size()) / static_cast<double>(count));
  };
  std::vector<double> norms(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    for (const std::uint32_t word : words[i]) norms[i] += std::pow(inverse_frequency(places_with[word].size()), 2);
    norms[i] = std::sqrt(norms[i]);
  }

  std::vector<PlaceCandidate> candidates;
  std::vector<double> scores(places.size());
  for (size_t later = 0; later < places.size(); ++later) {
    std::fill(scores.begin(), scores.end(), 0);
    for (const std::uint32_t word : words[later]) {
      const std::vector<size_t>& others = places_with[word];
      const double weight = std::pow(inverse_frequency(others.size()), 2);
      for (const size_t other : others) {
        if (other >= later) break;
        scores[other] += weight;
      }
    }
    std::vector<PlaceCandidate> found;
    for (size_t earlier = 0; earlier < later; ++earlier)
      if (scores[earlier] > 0 && is_possible(earlier, later))
        found.push_back({earlier, later, scores[earlier] / (norms[earlier] * norms[later])});
    std::stable_sort(found.begin(), found.end(),
                     [](const PlaceCandidate& a, const PlaceCandidate& b) { return a.score > b.score; });
    found.resize(std::min(found.size(), static_cast<size_t>(max_candidates)));
    candidates.insert(candidates.end(), found.begin(), found.end());
  }
  return candidates;
}

std::vector<PlaceCandidate> RecognisePlaces(const std::vector<Place>& places, const RecognitionOptions& options) {
  options.Validate();
  std::vector<const Place*> all;
  for (const Place& place : places) all.push_back(&place);
  return FindAlikePlaces(
      all, [&](size_t earlier, size_t later) { return IsPossible(places[earlier], places[later], options); },
      options.max_candidates);
}

}  // namespace parkade

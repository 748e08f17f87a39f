#include "slam/places/guided_matches.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "slam/places/hamming.h"

namespace parkade {
namespace {

constexpr double kPoseAngle = 0.3 * M_PI / 180;  // [rad] the pose may be off
constexpr double kPosePlace = 0.1;               // [m] the pose may be off
constexpr double kSigmas = 3;
constexpr double kMaxAngle =
    4 * M_PI / 180;  // [rad] between ray and point, beyond which a guess is useless

struct Guess {
  FeatureMatch match;
  int hamming = 0;
};

/// A keyframe's features by camera, with the one origin that the rays of a camera share.
std::map<int, std::vector<size_t>> ByCamera(const RigKeyframe& keyframe) {
  std::map<int, std::vector<size_t>> by_camera;
  for (size_t i = 0; i < keyframe.features.size(); ++i)
    by_camera[keyframe.features[i].camera].push_back(i);
  return by_camera;
}

/// The feature of `other` that looks most like feature `index` of `keyframe` among those near where
/// its point is seen.
std::optional<Guess> FindNear(const RigKeyframe& keyframe, size_t index, const RigKeyframe& other,
                              const std::map<int, std::vector<size_t>>& by_camera,
                              const Rigid3& other_from_keyframe,
                              const RelativePoseOptions& options) {
  const KeyframeFeature& feature = keyframe.features[index];
  const Eigen::Vector3d point = other_from_keyframe * *feature.point;
  const uchar* wanted = keyframe.descriptors.ptr(static_cast<int>(index));
  NearestDescriptor nearest;
  for (const auto& [camera, features] : by_camera) {
    const Eigen::Vector3d view = point - other.features[features.front()].origin;
    const double distance = view.norm();
    if (distance < 0.3) continue;
    const double off = std::hypot(kPosePlace, feature.depth_sigma) / distance;
    const double cosine = std::cos(std::min(kMaxAngle, kSigmas * std::hypot(off, kPoseAngle)));
    const Eigen::Vector3d direction = view / distance;
    for (const size_t i : features) {
      const int row = static_cast<int>(i);
      if (other.features[i].bearing.dot(direction) >= cosine)
        nearest.Add(row, HammingDistance(wanted, other.descriptors.ptr(row)));
    }
  }
  const std::optional<size_t> found = nearest.Found(options.max_hamming, options.ratio);
  return found ? std::optional(Guess{{index, *found}, nearest.distance}) : std::nullopt;
}

}  // namespace

std::vector<FeatureMatch> FindGuidedMatches(const RigKeyframe& a, const RigKeyframe& b,
                                            const Rigid3& a_from_b,
                                            const RelativePoseOptions& options) {
  std::vector<Guess> guesses;
  const auto look = [&](const RigKeyframe& keyframe, const RigKeyframe& other,
                        const Rigid3& other_from_keyframe, bool is_of_a) {
    const std::map<int, std::vector<size_t>> by_camera = ByCamera(other);
    for (size_t i = 0; i < keyframe.features.size(); ++i) {
      if (!keyframe.features[i].point) continue;
      std::optional<Guess> guess =
          FindNear(keyframe, i, other, by_camera, other_from_keyframe, options);
      if (!guess) continue;
      if (!is_of_a) std::swap(guess->match.a, guess->match.b);
      guesses.push_back(*guess);
    }
  };
  look(a, b, a_from_b.Inverse(), true);
  look(b, a, a_from_b, false);
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const Guess& x, const Guess& y) { return x.hamming < y.hamming; });
  std::vector<bool> is_taken_of_a(a.features.size()), is_taken_of_b(b.features.size());
  std::vector<FeatureMatch> matches;
  for (const Guess& guess : guesses) {
    if (is_taken_of_a[guess.match.a] || is_taken_of_b[guess.match.b]) continue;
    is_taken_of_a[guess.match.a] = is_taken_of_b[guess.match.b] = true;
    matches.push_back(guess.match);
  }
  return matches;
}

}  // namespace parkade

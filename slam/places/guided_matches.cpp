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

/// A keyframe's features in one camera: their rays begin at one place.
struct CameraFeatures {
  Eigen::Vector3d origin;
  std::vector<size_t> indices;
  Eigen::MatrixX3d bearings;  ///< side by side: most of the time goes into their products
};

std::vector<CameraFeatures> ByCamera(const RigKeyframe& keyframe) {
  std::map<int, std::vector<size_t>> by_camera;
  for (size_t i = 0; i < keyframe.features.size(); ++i)
    by_camera[keyframe.features[i].camera].push_back(i);
  std::vector<CameraFeatures> cameras;
  for (auto& [camera, indices] : by_camera) {
    CameraFeatures& of_camera = cameras.emplace_back();
    of_camera.origin = keyframe.features[indices.front()].origin;
    of_camera.bearings.resize(static_cast<Eigen::Index>(indices.size()), 3);
    Eigen::Index row = 0;
    for (const size_t i : indices) of_camera.bearings.row(row++) = keyframe.features[i].bearing;
    of_camera.indices = std::move(indices);
  }
  return cameras;
}

/// The feature of `other` that looks most like feature `index` of `keyframe` among those near where
/// its point is seen.
std::optional<Guess> FindNear(const RigKeyframe& keyframe, size_t index, const RigKeyframe& other,
                              const std::vector<CameraFeatures>& cameras,
                              const Rigid3& other_from_keyframe,
                              const RelativePoseOptions& options) {
  const KeyframeFeature& feature = keyframe.features[index];
  const Eigen::Vector3d point = other_from_keyframe * *feature.point;
  const uchar* wanted = keyframe.descriptors.ptr(static_cast<int>(index));
  NearestDescriptor nearest;
  Eigen::VectorXd cosines;
  for (const CameraFeatures& camera : cameras) {
    const Eigen::Vector3d view = point - camera.origin;
    const double distance = view.norm();
    if (distance < 0.3) continue;
    const double off = std::hypot(kPosePlace, feature.depth_sigma) / distance;
    const double cosine = std::cos(std::min(kMaxAngle, kSigmas * std::hypot(off, kPoseAngle)));
    const Eigen::Vector3d direction = view / distance;
    cosines.noalias() = camera.bearings * direction;
    for (size_t i = 0; i < camera.indices.size(); ++i) {
      if (cosines[static_cast<Eigen::Index>(i)] < cosine) continue;
      const int row = static_cast<int>(camera.indices[i]);
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
    const std::vector<CameraFeatures> cameras = ByCamera(other);
    for (size_t i = 0; i < keyframe.features.size(); ++i) {
      if (!keyframe.features[i].point) continue;
      std::optional<Guess> guess =
          FindNear(keyframe, i, other, cameras, other_from_keyframe, options);
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

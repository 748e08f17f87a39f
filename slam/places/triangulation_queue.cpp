#include "slam/places/triangulation_queue.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "slam/places/triangulate_keyframes.h"

namespace parkade {
namespace {

constexpr size_t kKeyframesPerPiece = 32;  // that are triangulated at once

}  // namespace

TriangulationQueue::TriangulationQueue(std::vector<RigKeyframe> keyframes,
                                       const KeyframeOptions& options, KeyframeSink sink)
    : keyframes_(std::move(keyframes)), options_(options), sink_(std::move(sink)) {}

void TriangulationQueue::Complete(size_t end) {
  const bool is_all = end == keyframes_.size();
  const size_t ready = is_all ? end : end - std::min(end, kNeighborKeyframes);
  if (ready < num_done_ + (is_all ? 0 : kKeyframesPerPiece)) return;
  std::vector<std::vector<KeyframeFeature>> features = ParallelMap(
      ready - num_done_,
      [&](size_t i) { return TriangulateFeatures(keyframes_, num_done_ + i, options_); });
  for (size_t i = num_done_; i < ready; ++i) {
    RigKeyframe done = keyframes_[i];
    done.features = std::move(features[i - num_done_]);
    sink_(std::move(done));
  }
  num_done_ = ready;
  for (; num_forgotten_ + kNeighborKeyframes < num_done_; ++num_forgotten_) {
    RigKeyframe& past = keyframes_[num_forgotten_];  // whose time is read on other threads
    past.features = {};
    past.descriptors.release();
    past.views = {};
    past.floor.release();
  }
}

}  // namespace parkade

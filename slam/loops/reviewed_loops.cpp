#include "slam/loops/reviewed_loops.h"

#include <algorithm>
#include <charconv>

#include "core/error.h"

namespace parkade {
namespace {

constexpr int kMinInliersOfForced = 6;  // fewer fix no pose, whatever a reviewer wants
constexpr size_t kNeighbors = 2;        // on each side, whose images give the points of a keyframe

std::string IdOf(const PlaceCandidate& loop) {
  return std::to_string(loop.earlier) + "-" + std::to_string(loop.later);
}

PlaceCandidate ParseId(const std::string& id, size_t num_keyframes) {
  PlaceCandidate loop;
  const char* const end = id.data() + id.size();
  const auto first = std::from_chars(id.data(), end, loop.earlier);
  const bool has_dash = first.ec == std::errc() && first.ptr != end && *first.ptr == '-';
  const auto second = has_dash ? std::from_chars(first.ptr + 1, end, loop.later) : first;
  Require(has_dash && second.ec == std::errc() && second.ptr == end && loop.earlier < loop.later &&
              loop.later < num_keyframes,
          ErrorCode::kUsage,
          "no loop of this drive is called '" + id +
              "'; report.json names them, EARLIER-LATER, with places below " +
              std::to_string(num_keyframes));
  return loop;
}

bool Holds(const std::vector<PlaceCandidate>& loops, const std::string& id) {
  return std::any_of(loops.begin(), loops.end(),
                     [&](const PlaceCandidate& loop) { return IdOf(loop) == id; });
}

}  // namespace

ReviewedLoops::ReviewedLoops(const LoopReview& review, size_t num_keyframes) {
  for (const std::string& id : review.rejected) rejected_.push_back(ParseId(id, num_keyframes));
  for (const std::string& id : review.forced) {
    forced_.push_back(ParseId(id, num_keyframes));
    Require(!Holds(rejected_, id), ErrorCode::kUsage,
            "loop '" + id + "' is both rejected and forced");
  }
}

void ReviewedLoops::MarkKeyframes(std::vector<bool>& is_wanted) const {
  for (const PlaceCandidate& loop : forced_)
    for (const size_t keyframe : {loop.earlier, loop.later})
      for (size_t i = keyframe - std::min(keyframe, kNeighbors);
           i <= std::min(keyframe + kNeighbors, is_wanted.size() - 1); ++i)
        is_wanted[i] = true;
}

void ReviewedLoops::AddForced(std::vector<PlaceCandidate>& candidates) const {
  for (const PlaceCandidate& loop : forced_)
    if (!Holds(candidates, IdOf(loop))) candidates.push_back(loop);
}

void ReviewedLoops::Judge(LoopEvidence& loop) const {
  if (Holds(rejected_, loop.id)) loop.pose.rejected = "rejected by the reviewer";
  if (!Holds(forced_, loop.id)) return;
  loop.is_forced = loop.pose.num_inliers >= kMinInliersOfForced &&
                   loop.pose.information.diagonal().minCoeff() > 0;
  loop.pose.rejected = loop.is_forced ? "" : "forced, but cannot be measured";
}

}  // namespace parkade

#include "server/ingest/messages/transform_graph.h"

#include <deque>

namespace parkade {

std::string PlainFrame(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

void TransformGraph::Add(const TransformMessage& transform) {
  Rigid3 parent_from_child = transform.parent_from_child;
  const double norm = parent_from_child.rotation.norm();
  if (!(std::abs(norm - 1) < 0.01) || !parent_from_child.translation.allFinite()) return;
  parent_from_child.rotation.normalize();
  const std::string parent = PlainFrame(transform.header.frame_id),
                    child = PlainFrame(transform.child_frame_id);
  neighbors_[parent][child] = parent_from_child;
  neighbors_[child][parent] = parent_from_child.Inverse();
}

bool TransformGraph::Has(const std::string& frame) const {
  return neighbors_.contains(PlainFrame(frame));
}

std::optional<Rigid3> TransformGraph::Find(const std::string& target,
                                           const std::string& source) const {
  const std::string goal = PlainFrame(source);
  std::map<std::string, Rigid3> target_from_frame{{PlainFrame(target), Rigid3{}}};
  std::deque<std::string> open{PlainFrame(target)};
  while (!open.empty()) {
    const std::string frame = open.front();
    open.pop_front();
    if (frame == goal) return target_from_frame[frame];
    const auto neighbors = neighbors_.find(frame);
    if (neighbors == neighbors_.end()) continue;
    for (const auto& [other, frame_from_other] : neighbors->second) {
      if (!target_from_frame.emplace(other, target_from_frame[frame] * frame_from_other).second)
        continue;
      open.push_back(other);
    }
  }
  return std::nullopt;
}

}  // namespace parkade

#include "mapping/mesh/deform_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"
#include "mapping/mesh/mesh_samples.h"

namespace parkade {
namespace {

constexpr double kReach = 12;            // [m] within which a keyframe saw ground and holds it
constexpr size_t kKeyframesPerNode = 8;  // the nearest of them
constexpr double kKeyframeSpacing = 2;   // [m] between those that are used of one drive
constexpr double kStiffness = 0.01;      // [m/m] and [rad] by which neighboring nodes may disagree
constexpr double kSeenSigma =
    0.02;                          // [m] of ground beside a keyframe, and 0.01 more per meter away
constexpr double kLevelGap = 1.0;  // [m] of height between nodes of one column: more are two decks
constexpr double kLevelBase = 0.6,
                 kLevelSlope =
                     0.1;  // [m], and per meter: heights within which a keyframe saw ground
constexpr double kSigmaPerMeter = 0.01;  // of what a keyframe saw
constexpr double kHeightCounts = 3;      // heights count this much more when nodes are looked for
constexpr size_t kBlended = 4;           // nodes per point, as in the paper

/// Those at least `spacing` from the one used before.
std::vector<MovedKeyframe> ThinOut(std::span<const MovedKeyframe> keyframes, double spacing) {
  std::vector<MovedKeyframe> used;
  for (const MovedKeyframe& keyframe : keyframes)
    if (used.empty() ||
        (keyframe.from_from_body.translation - used.back().from_from_body.translation).norm() >=
            spacing)
      used.push_back(keyframe);
  return used;
}

/// What moves a point of the old site as the keyframe moved.
Rigid3 MotionOf(const MovedKeyframe& keyframe) {
  return keyframe.to_from_body * keyframe.from_from_body.Inverse();
}

/// How far a keyframe stands from ground that it saw; nothing where it did not.
std::optional<double> ObservationOf(const MovedKeyframe& keyframe, const Eigen::Vector3d& ground) {
  const Eigen::Vector3d apart = ground - keyframe.from_from_body.translation;
  const double distance = apart.head<2>().norm();
  if (distance > kReach || std::abs(apart.z()) > kLevelBase + kLevelSlope * distance)
    return std::nullopt;
  return distance;
}

/// The observations of one piece of ground, the nearest first.
std::vector<std::pair<double, size_t>> ObservationsOf(const std::vector<MovedKeyframe>& keyframes,
                                                      const Eigen::Vector3d& ground) {
  std::vector<std::pair<double, size_t>> observations;
  for (size_t i = 0; i < keyframes.size(); ++i)
    if (const std::optional<double> distance = ObservationOf(keyframes[i], ground))
      observations.emplace_back(*distance, i);
  std::sort(observations.begin(), observations.end());
  if (observations.size() > kKeyframesPerNode) observations.resize(kKeyframesPerNode);
  return observations;
}

/// As the keyframe moved that is nearest, heights counting most: where a node begins.
Rigid3 NearestMotion(const std::vector<MovedKeyframe>& keyframes, const Eigen::Vector3d& ground) {
  const auto nearest =
      std::min_element(keyframes.begin(), keyframes.end(), [&](const auto& a, const auto& b) {
        const auto cost = [&](const MovedKeyframe& keyframe) {
          const Eigen::Vector3d apart = ground - keyframe.from_from_body.translation;
          return apart.head<2>().norm() + kHeightCounts * std::abs(apart.z());
        };
        return cost(a) < cost(b);
      });
  return MotionOf(*nearest);
}

}  // namespace

/// Puts together what holds what; nodes of the ground first, keyframes after them.
class DeformationBuilder {
 public:
  /// \param share  of the ground's information that counts
  DeformationBuilder(const TriangleMesh& mesh, const DeformationOptions& options, double share)
      : options_(options), slack_(1 / std::sqrt(share)) {
    const MeshSamples samples = SampleMesh(mesh, 0.5 * options.spacing);
    const NodeSamples grouped = GroupSamples(samples, options.spacing, kLevelGap);
    deformation_.spacing_ = options.spacing;
    deformation_.num_ground_nodes_ = grouped.nodes.size();
    deformation_.neighbors_.resize(grouped.nodes.size());
    for (const Eigen::Vector3d& rest : grouped.nodes) {
      deformation_.columns_[SquareOf(rest, options.spacing)].push_back(graph().nodes.size());
      graph().nodes.push_back({rest, {Eigen::Quaterniond::Identity(), rest}});
    }
    JoinNeighbors(samples, grouped);
  }

  /// Ground begins as the nearest of these moved, and hangs on those that saw it; `nodes` are
  /// theirs.
  void HangOn(const std::vector<MovedKeyframe>& keyframes, const std::vector<size_t>& nodes) {
    for (size_t i = 0; i < deformation_.num_ground_nodes_; ++i) {
      DeformationNode& node = graph().nodes[i];
      const Rigid3 motion = NearestMotion(keyframes, node.rest);
      node.motion = {motion.rotation, motion * node.rest};
      const std::vector<std::pair<double, size_t>> observations =
          ObservationsOf(keyframes, node.rest);
      deformation_.is_seen_.push_back(!observations.empty());
      for (const auto& [distance, keyframe] : observations)
        HoldEachOther(i, nodes[keyframe], kSeenSigma + kSigmaPerMeter * distance,
                      kStiffness * (1 + distance));
    }
  }

  size_t AddKeyframe(const MovedKeyframe& keyframe) {
    const Rigid3 motion = MotionOf(keyframe);
    const Eigen::Vector3d& rest = keyframe.from_from_body.translation;
    graph().nodes.push_back(
        {rest, {motion.rotation, motion * rest}, keyframe.from_from_body.rotation});
    return graph().nodes.size() - 1;
  }
  void Hold(size_t node) {
    graph().anchors.push_back({.node = node, .motion = graph().nodes[node].motion});
  }

  DeformationGraph& graph() { return deformation_.graph_; }

  MeshDeformation Solve() && {
    SolveDeformation(graph());
    return std::move(deformation_);
  }

 private:
  void HoldEachOther(size_t a, size_t b, double sigma, double turn_sigma) {
    graph().edges.push_back({a, b, slack_ * sigma, slack_ * turn_sigma});
    graph().edges.push_back({b, a, slack_ * sigma, slack_ * turn_sigma});
  }

  void JoinNeighbors(const MeshSamples& samples, const NodeSamples& grouped) {
    std::set<std::pair<size_t, size_t>> joined;
    for (const auto& [a, b] : samples.links) {
      const auto [first, second] =
          std::minmax(grouped.node_of_sample[a], grouped.node_of_sample[b]);
      if (first == second || !joined.insert({first, second}).second) continue;
      const double distance = (graph().nodes[first].rest - graph().nodes[second].rest).norm();
      HoldEachOther(first, second, kStiffness * std::max(distance, 0.1), kStiffness);
      deformation_.neighbors_[first].push_back(second);
      deformation_.neighbors_[second].push_back(first);
    }
  }

  const DeformationOptions& options_;
  double slack_;  // factor on the sigmas of all edges
  MeshDeformation deformation_;
};

MeshDeformation DeformGround(const TriangleMesh& mesh, std::span<const MovedKeyframe> all_keyframes,
                             const DeformationOptions& options) {
  Require(!all_keyframes.empty(), ErrorCode::kInvalidInput,
          "nothing says how the ground has moved");
  const std::vector<MovedKeyframe> keyframes = ThinOut(all_keyframes, kKeyframeSpacing);
  DeformationBuilder builder(mesh, options, /*share=*/1);
  std::vector<size_t> nodes;
  for (const MovedKeyframe& keyframe : keyframes) {
    nodes.push_back(builder.AddKeyframe(keyframe));
    builder.Hold(nodes.back());
  }
  builder.HangOn(keyframes, nodes);
  return std::move(builder).Solve();
}

JointDeformation DeformJointly(const TriangleMesh& mesh, std::span<const FreeKeyframe> keyframes,
                               std::span<const DeformationMeasurement> measurements,
                               const DeformationOptions& options) {
  DeformationBuilder builder(mesh, options, options.ground_share);
  std::vector<MovedKeyframe> old_keyframes;  // those that the ground hangs on
  std::vector<size_t> nodes, old_nodes;
  for (const FreeKeyframe& keyframe : keyframes) {
    nodes.push_back(builder.AddKeyframe(
        {keyframe.from_from_body.value_or(keyframe.to_from_body), keyframe.to_from_body}));
    if (keyframe.is_held) builder.Hold(nodes.back());
    if (!keyframe.from_from_body) continue;
    old_keyframes.push_back({*keyframe.from_from_body, keyframe.to_from_body});
    old_nodes.push_back(nodes.back());
  }
  Require(!old_keyframes.empty(), ErrorCode::kInvalidInput,
          "nothing says how the ground has moved");
  builder.HangOn(old_keyframes, old_nodes);
  for (DeformationMeasurement measurement : measurements) {
    if (measurement.from) measurement.from = nodes[*measurement.from];
    measurement.to = nodes[measurement.to];
    builder.graph().measurements.push_back(measurement);
  }
  JointDeformation joint{std::move(builder).Solve(), {}};
  for (const size_t node : nodes)
    joint.to_from_body.push_back(joint.ground.graph().nodes[node].Pose());
  return joint;
}

double MeshDeformation::DistanceTo(size_t node, const Eigen::Vector3d& point) const {
  const Eigen::Vector3d apart = point - graph_.nodes[node].rest;
  return std::hypot(apart.x(), apart.y(), kHeightCounts * apart.z());
}

size_t MeshDeformation::NodeNear(const Eigen::Vector3d& point) const {
  std::pair<double, size_t> nearest{std::numeric_limits<double>::max(), 0};
  const auto [column, row] = SquareOf(point, spacing_);
  for (int x = column - 1; x <= column + 1; ++x)
    for (int y = row - 1; y <= row + 1; ++y)
      if (const auto found = columns_.find({x, y}); found != columns_.end())
        for (const size_t node : found->second)
          nearest = std::min(nearest, {DistanceTo(node, point), node});
  if (nearest.first == std::numeric_limits<double>::max())  // off the ground
    for (size_t node = 0; node < num_ground_nodes_; ++node)
      nearest = std::min(nearest, {DistanceTo(node, point), node});
  return nearest.second;
}

bool MeshDeformation::IsSeen(const Eigen::Vector3d& point) const {
  return num_ground_nodes_ > 0 && is_seen_[NodeNear(point)];
}

Eigen::Vector3d MeshDeformation::Apply(const Eigen::Vector3d& point) const {
  if (num_ground_nodes_ == 0) return graph_.nodes.front().Carry(point);
  const size_t own = NodeNear(point);
  std::vector<std::pair<double, size_t>> near = {{DistanceTo(own, point), own}};
  for (const size_t node : neighbors_[own]) near.emplace_back(DistanceTo(node, point), node);
  std::sort(near.begin() + 1, near.end());
  if (near.size() > kBlended + 1) near.resize(kBlended + 1);
  // The farthest of them has no weight: points cross from one set of nodes to the next without a
  // jump.
  const double edge =
      near.size() > 1 ? std::max_element(near.begin(), near.end())->first * (1 + 1e-9) : 1;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (const auto& [distance, node] : near) {
    const double weight = near.size() > 1 ? std::pow(std::max(1 - distance / edge, 1e-6), 2) : 1;
    sum += weight * graph_.nodes[node].Carry(point);
    total += weight;
  }
  return sum / total;
}

}  // namespace parkade

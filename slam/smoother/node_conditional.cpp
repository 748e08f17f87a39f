#include "slam/smoother/node_conditional.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <optional>

#include "core/binary_serialization.h"
#include "slam/smoother/recorded_states.h"

namespace parkade {

// Found by argument-dependent lookup, hence in the types' own namespace.
template <typename A>
void Serialize(A& archive, StateName& name) {
  archive(name.kind, name.number);
}
template <typename A>
void Serialize(A& archive, PriorBlock& block) {
  archive(block.name, block.at);
}
template <typename A>
void Serialize(A& archive, StateConditional& conditional) {
  archive(conditional.states, conditional.own, conditional.to_rest, conditional.offset,
          conditional.offset_covariance, conditional.score_with_offset,
          conditional.offset_sensitivity, conditional.rest);
}
template <typename A>
void Serialize(A& archive, NodeConditionals& conditionals) {
  archive(conditionals.own, conditionals.reopened);
}

namespace {

constexpr std::int64_t kMaxWindow = 128;  // nodes; SmootherOptions allows fewer

/// Values of states by name: the newest nodes smoothed so far, and what all share.
using StateValues = std::map<StateName, std::array<double, 9>>;

/// Covariance of the states that the next conditional may speak of.
struct JointCovariance {
  std::vector<StateName> names;
  std::vector<Eigen::Index> columns;  // where each begins
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd model;        // inverse information
  Eigen::MatrixXd sensitivity;  // by what is considered, which `matrix` leaves out

  void Append(const StateName& name) {
    columns.push_back(names.empty() ? 0 : columns.back() + names.back().TangentSize());
    names.push_back(name);
  }
};

/// Columns of `names` in `joint`; nothing when one is not in it.
std::optional<std::vector<Eigen::Index>> ColumnsOf(const JointCovariance& joint,
                                                   const std::vector<StateName>& names) {
  std::vector<Eigen::Index> columns;
  for (const StateName& name : names) {
    const auto found = std::find(joint.names.begin(), joint.names.end(), name);
    if (found == joint.names.end()) return std::nullopt;
    const Eigen::Index begin = joint.columns[static_cast<size_t>(found - joint.names.begin())];
    for (int k = 0; k < name.TangentSize(); ++k) columns.push_back(begin + k);
  }
  return columns;
}

/// The joint covariance of a conditional's states and its rest. A state of the
/// rest that has the name of one of its own (a camera reopened) is left out.
std::optional<JointCovariance> Extend(const StateConditional& conditional,
                                      const JointCovariance& joint) {
  std::vector<StateName> rest_names;
  for (const PriorBlock& block : conditional.rest) rest_names.push_back(block.name);
  const std::optional<std::vector<Eigen::Index>> from = ColumnsOf(joint, rest_names);
  if (!from) return std::nullopt;
  const Eigen::MatrixXd rest = joint.matrix(*from, *from), model_rest = joint.model(*from, *from);
  const Eigen::MatrixXd own = conditional.own.cast<double>();
  const auto root = own.triangularView<Eigen::Upper>();
  // Own error = gain (error of the rest) - inverse z; z goes with the rest's error as far as their
  // scores do.
  const Eigen::MatrixXd gain = -root.solve(conditional.to_rest.cast<double>());
  const Eigen::MatrixXd inverse = root.solve(Eigen::MatrixXd::Identity(own.rows(), own.cols()));
  const Eigen::MatrixXd model_cross = gain * model_rest;
  const Eigen::MatrixXd rest_with_own_offset =
      -model_rest * conditional.score_with_offset.cast<double>() * inverse.transpose();
  const Eigen::MatrixXd cross = gain * rest - rest_with_own_offset.transpose();
  const Eigen::MatrixXd mixed = gain * rest_with_own_offset;

  JointCovariance all;
  for (const PriorBlock& block : conditional.states) all.Append(block.name);
  for (const StateName& name : rest_names) all.Append(name);
  const Eigen::Index size = own.rows() + rest.rows();
  all.matrix.resize(size, size);
  all.matrix << gain * rest * gain.transpose() - mixed - mixed.transpose() +
                    inverse * conditional.offset_covariance.cast<double>() * inverse.transpose(),
      cross, cross.transpose(), rest;
  all.model.resize(size, size);
  all.model << inverse * inverse.transpose() + model_cross * gain.transpose(), model_cross,
      model_cross.transpose(), model_rest;
  const Eigen::MatrixXd rest_sensitivity = joint.sensitivity(*from, Eigen::all);
  all.sensitivity.resize(size, rest_sensitivity.cols());
  all.sensitivity << gain * rest_sensitivity -
                         inverse * conditional.offset_sensitivity.cast<double>(),
      rest_sensitivity;
  if (!all.matrix.allFinite() || !all.model.allFinite()) return std::nullopt;
  JointCovariance unique;
  for (const StateName& name : all.names)
    if (std::find(unique.names.begin(), unique.names.end(), name) == unique.names.end())
      unique.Append(name);
  if (unique.names.size() == all.names.size()) return all;
  const std::optional<std::vector<Eigen::Index>> kept = ColumnsOf(all, unique.names);
  unique.matrix = all.matrix(*kept, *kept);
  unique.model = all.model(*kept, *kept);
  unique.sensitivity = all.sensitivity(*kept, Eigen::all);
  return unique;
}

/// rest [-] at, or nothing when a state in it is not known.
std::optional<Eigen::VectorXd> DeviationOfRest(const StateConditional& conditional,
                                               const StateValues& smoothed) {
  Eigen::VectorXd deviation(conditional.to_rest.cols());
  Eigen::Index column = 0;
  for (const PriorBlock& block : conditional.rest) {
    const auto found = smoothed.find(block.name);
    if (found == smoothed.end()) return std::nullopt;
    block.Deviation(found->second.data(), deviation.data() + column);
    column += block.TangentSize();
  }
  return deviation;
}

/// Puts the conditional's states into `smoothed`, corrected where that can be done.
void SmoothStates(const StateConditional& conditional, StateValues& smoothed) {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(conditional.own.rows());
  if (const std::optional<Eigen::VectorXd> deviation = DeviationOfRest(conditional, smoothed)) {
    const Eigen::VectorXd right =
        -(conditional.offset.cast<double>() + conditional.to_rest.cast<double>() * *deviation);
    const Eigen::MatrixXd own = conditional.own.cast<double>();
    const Eigen::VectorXd solved = own.triangularView<Eigen::Upper>().solve(right);
    if (solved.allFinite()) change = solved;
  }
  const double* by = change.data();
  for (const PriorBlock& block : conditional.states) {
    std::array<double, 9> values = block.at;
    if (block.name.IsPose())
      PoseManifold().Plus(block.at.data(), by, values.data());
    else
      for (int k = 0; k < block.Size(); ++k) values[static_cast<size_t>(k)] += by[k];
    smoothed[block.name] = values;
    by += block.TangentSize();
  }
}

void Forget(StateValues& smoothed, std::int64_t from_node) {
  std::erase_if(smoothed, [&](const auto& entry) {
    return entry.first.IsOfNode() && entry.first.number >= from_node;
  });
}

}  // namespace

void ConditionalStore::Add(NodeConditionals conditionals) { store_.Add(conditionals); }

NodeConditionals ConditionalStore::operator[](size_t node) const { return store_[node]; }

void SmoothBackwards(std::vector<RecordedNode>& nodes, const ConditionalStore& conditionals,
                     const JointEstimate& last) {
  assert(conditionals.size() == nodes.size());
  StateValues smoothed;
  std::optional<JointCovariance> joint;
  if (last.covariance.size() > 0) {
    joint.emplace().matrix = last.covariance - last.sensitivity * last.sensitivity.transpose();
    joint->model = last.model_covariance;
    joint->sensitivity = last.sensitivity;
  }
  for (const PriorBlock& block : last.states) {
    smoothed[block.name] = block.at;
    if (joint) joint->Append(block.name);
  }
  const auto apply = [&](const StateConditional& conditional) {
    SmoothStates(conditional, smoothed);
    if (joint) joint = Extend(conditional, *joint);
  };
  for (size_t i = nodes.size(); i-- > 0;) {
    RecordedNode& node = nodes[i];
    const NodeConditionals learned = conditionals[i];
    if (learned.own) {
      apply(*learned.own);
      const MotionState state = StateFromParameters(
          node.state.time, smoothed[{StateName::Kind::kPose, node.number}].data(),
          smoothed[{StateName::Kind::kMotion, node.number}].data());
      if (state.IsFinite()) node.state = state;
    }
    if (joint) {
      const auto sensitivity = joint->sensitivity.topRows<6>();
      node.covariance = joint->matrix.topLeftCorner<6, 6>() + sensitivity * sensitivity.transpose();
    }
    for (auto reopened = learned.reopened.rbegin(); reopened != learned.reopened.rend(); ++reopened)
      apply(*reopened);
    Forget(smoothed, node.number + kMaxWindow);
  }
}

}  // namespace parkade

#include "slam/schur/schur_structure.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>

namespace parkade {
namespace {

constexpr int kChunkColumns = 384;  // a dense system that a core's cache holds

struct HashOfStates {
  size_t operator()(const std::vector<int>& states) const {
    std::uint64_t hash = 14695981039346656037u;  // as G. Fowler, L. Noll and P. Vo have it
    for (const int state : states)
      hash = (hash ^ static_cast<std::uint32_t>(state)) * 1099511628211u;
    return static_cast<size_t>(hash);
  }
};

}  // namespace

/// What a problem says, as long as it is sorted.
struct SchurStructure::Reading {
  const ceres::Problem& problem;
  std::unordered_map<const double*, int> state_of;  // kHeldState where it does not move
  std::unordered_map<const double*, size_t> landmark_of;

  Reading(const ceres::Problem& of, const std::vector<double*>& landmarks) : problem(of) {
    landmark_of.reserve(landmarks.size());
    for (const double* landmark : landmarks) landmark_of.emplace(landmark, landmark_of.size());
  }
};

SchurStructure::SchurStructure(const ceres::Problem& problem,
                               const std::vector<double*>& landmarks) {
  Reading reading(problem, landmarks);
  AddStates(reading);
  AddGroups(reading);
  CutIntoChunks();
}

void SchurStructure::AddStates(Reading& reading) {
  std::vector<double*> blocks;
  reading.problem.GetParameterBlocks(&blocks);
  std::sort(blocks.begin(), blocks.end());
  for (double* block : blocks) {
    if (reading.landmark_of.contains(block)) continue;
    if (reading.problem.IsParameterBlockConstant(block)) {
      reading.state_of.emplace(block, kHeldState);
      continue;
    }
    reading.state_of.emplace(block, static_cast<int>(states.size()));
    states.push_back({block, reading.problem.ParameterBlockSize(block),
                      reading.problem.ParameterBlockTangentSize(block), num_columns,
                      reading.problem.GetManifold(block)});
    num_columns += states.back().tangent_size;
  }
}

void SchurStructure::AddGroups(const Reading& reading) {
  struct Entry {
    size_t group;
    ceres::ResidualBlockId id;
    std::vector<double*> blocks;
  };
  std::vector<ceres::ResidualBlockId> ids;
  reading.problem.GetResidualBlocks(&ids);
  std::vector<Entry> entries;
  entries.reserve(ids.size());
  size_t num_others = 0;
  for (const ceres::ResidualBlockId id : ids) {
    std::vector<double*> blocks;
    reading.problem.GetParameterBlocksForResidualBlock(id, &blocks);
    const auto landmark = reading.landmark_of.find(blocks.back());
    const size_t group = landmark != reading.landmark_of.end()
                             ? landmark->second
                             : reading.landmark_of.size() + num_others++;
    entries.push_back({group, id, std::move(blocks)});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.group < b.group; });
  for (size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].group != entries[i - 1].group) {
      SchurGroup& group = groups.emplace_back();
      group.first_factor = static_cast<std::uint32_t>(factors.size());
      if (entries[i].group < reading.landmark_of.size()) {
        group.landmark = entries[i].blocks.back();
        ++num_landmarks;
      }
    }
    AddFactor(reading, entries[i].id, entries[i].blocks);
    groups.back().end_factor = static_cast<std::uint32_t>(factors.size());
  }
}

void SchurStructure::AddFactor(const Reading& reading, ceres::ResidualBlockId id,
                               const std::vector<double*>& blocks) {
  factors.push_back({reading.problem.GetCostFunctionForResidualBlock(id),
                     reading.problem.GetLossFunctionForResidualBlock(id),
                     static_cast<std::uint32_t>(parameters.size())});
  for (size_t i = 0; i < blocks.size(); ++i) {
    SchurParameter& parameter = parameters.emplace_back();
    parameter.values = blocks[i];
    parameter.size = static_cast<std::int16_t>(factors.back().cost->parameter_block_sizes()[i]);
    const auto state = reading.state_of.find(blocks[i]);
    if (state == reading.state_of.end() || state->second == kHeldState) continue;
    parameter.state = state->second;
    parameter.tangent_size =
        static_cast<std::int16_t>(states[static_cast<size_t>(parameter.state)].tangent_size);
  }
}

std::vector<int> SchurStructure::StatesOf(const SchurGroup& group) const {
  std::vector<int> touched;
  for (std::uint32_t i = group.first_factor; i < group.end_factor; ++i)
    for (const SchurParameter& parameter : ParametersOf(factors[i]))
      if (parameter.state != kHeldState) touched.push_back(parameter.state);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

int SchurStructure::ColumnsOf(const std::vector<int>& of) const {
  int count = 0;
  for (const int state : of) count += states[static_cast<size_t>(state)].tangent_size;
  return count;
}

// Landmarks in the order of the first states that see them, so that neighbors share most.
void SchurStructure::CutIntoChunks() {
  std::vector<std::pair<std::vector<int>, SchurGroup>> sorted;
  for (const SchurGroup& group : groups) sorted.emplace_back(StatesOf(group), group);
  std::stable_sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(num_landmarks),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t i = 0; i < sorted.size(); ++i) {
    const std::vector<int>& touched = sorted[i].first;
    groups[i] = sorted[i].second;
    std::vector<int> together;
    if (!chunks.empty())
      std::set_union(chunks.back().states.begin(), chunks.back().states.end(), touched.begin(),
                     touched.end(), std::back_inserter(together));
    if (chunks.empty() || i == num_landmarks || ColumnsOf(together) > kChunkColumns) {
      chunks.emplace_back().first_group = static_cast<std::uint32_t>(i);
      together = touched;
    }
    chunks.back().states = std::move(together);
    chunks.back().end_group = static_cast<std::uint32_t>(i + 1);
  }
  for (SchurChunk& chunk : chunks) {
    Place(chunk);
    FindFootprints(chunk);
  }
}

void SchurStructure::Place(SchurChunk& chunk) {
  chunk.columns = {0};
  for (const int state : chunk.states)
    chunk.columns.push_back(chunk.columns.back() + states[static_cast<size_t>(state)].tangent_size);
  const size_t count = chunk.states.size();
  std::vector<bool> is_tied(count * count);
  for (std::uint32_t g = chunk.first_group; g < chunk.end_group; ++g) {
    Place(chunk, groups[g]);
    std::vector<size_t> touched;
    for (const int state : StatesOf(groups[g]))
      touched.push_back(
          static_cast<size_t>(std::lower_bound(chunk.states.begin(), chunk.states.end(), state) -
                              chunk.states.begin()));
    for (size_t i = 0; i < touched.size(); ++i)
      for (size_t j = 0; j <= i; ++j) is_tied[touched[i] * count + touched[j]] = true;
  }
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j <= i; ++j)
      if (is_tied[i * count + j])
        chunk.pairs.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)});
}

void SchurStructure::FindFootprints(SchurChunk& chunk) {
  std::unordered_map<std::vector<int>, std::uint32_t, HashOfStates> known;
  std::vector<int> moved;
  chunk.first_footprint = static_cast<std::uint32_t>(footprints.size());
  for (std::uint32_t g = chunk.first_group; g < chunk.end_group; ++g)
    for (std::uint32_t i = groups[g].first_factor; i < groups[g].end_factor; ++i) {
      moved.clear();
      int width = 0;
      for (size_t k = 0; k < factors[i].cost->parameter_block_sizes().size(); ++k) {
        SchurParameter& parameter = parameters[factors[i].first_parameter + k];
        moved.push_back(parameter.state);
        if (parameter.state == kHeldState) continue;
        parameter.local = width;
        width += parameter.tangent_size;
      }
      const auto [found, is_new] =
          known.try_emplace(moved, static_cast<std::uint32_t>(footprints.size()));
      if (is_new) footprints.push_back({i, width});
      factors[i].footprint = found->second;
    }
  chunk.end_footprint = static_cast<std::uint32_t>(footprints.size());
}

void SchurStructure::Place(const SchurChunk& chunk, SchurGroup& group) {
  const std::vector<int> touched = StatesOf(group);
  std::vector<int> packed;
  group.first_run = static_cast<std::uint32_t>(runs.size());
  const auto column_of = [&](int state) {
    return chunk.columns[static_cast<size_t>(
        std::lower_bound(chunk.states.begin(), chunk.states.end(), state) - chunk.states.begin())];
  };
  for (const int state : touched) {
    const int column = column_of(state), size = states[static_cast<size_t>(state)].tangent_size;
    packed.push_back(group.num_columns);
    if (runs.size() > group.first_run && runs.back().column + runs.back().count == column)
      runs.back().count += size;
    else
      runs.push_back({column, group.num_columns, size});
    group.num_columns += size;
  }
  group.end_run = static_cast<std::uint32_t>(runs.size());
  for (std::uint32_t i = group.first_factor; i < group.end_factor; ++i)
    for (size_t k = 0; k < factors[i].cost->parameter_block_sizes().size(); ++k) {
      SchurParameter& parameter = parameters[factors[i].first_parameter + k];
      if (parameter.state == kHeldState) continue;
      parameter.column = column_of(parameter.state);
      parameter.packed = packed[static_cast<size_t>(
          std::lower_bound(touched.begin(), touched.end(), parameter.state) - touched.begin())];
    }
}

}  // namespace parkade

#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <cstdint>
#include <span>
#include <vector>

namespace parkade {

/// A free unknown that is no landmark.
struct SchurState {
  double* values = nullptr;
  int size = 0, tangent_size = 0;
  int column = 0;                             ///< its first in the system
  const ceres::Manifold* manifold = nullptr;  ///< null: values add
};

inline constexpr int kSchurLandmarkSize = 3;
inline constexpr int kHeldState = -1;

/// A parameter block of a factor.
struct SchurParameter {
  const double* values = nullptr;
  std::int16_t size = 0;
  std::int16_t tangent_size = 0;    ///< of a state
  std::int32_t state = kHeldState;  ///< kHeldState also of landmarks
  std::int32_t column = 0;          ///< of a state: its first in the chunk
  std::int32_t local = 0;           ///< of a state: its first among those of the factor
  std::int32_t packed = 0;          ///< its first among the columns that its group touches
};

struct SchurFactor {
  const ceres::CostFunction* cost = nullptr;
  const ceres::LossFunction* loss = nullptr;  ///< null: none
  std::uint32_t first_parameter = 0;          ///< as many as `cost` has follow
  std::uint32_t footprint = 0;
};

/// The states that factors of a chunk move together, as bearings of one image do. Their products
/// are summed up in a small matrix first.
struct SchurFootprint {
  std::uint32_t factor = 0;  ///< one of them
  int width = 0;             ///< columns of its states
};

/// Neighboring columns of a chunk that a group touches.
struct SchurRun {
  std::int32_t column = 0, packed = 0, count = 0;
};

/// All factors of one landmark, whose last parameter it is; or one factor without.
struct SchurGroup {
  double* landmark = nullptr;  ///< kSchurLandmarkSize values; null: none
  std::uint32_t first_factor = 0, end_factor = 0;
  std::uint32_t first_run = 0, end_run = 0;  ///< ascending
  int num_columns = 0;
};

/// Two states that some group of a chunk ties together, as indices into the chunk's; row >= column.
struct SchurPair {
  std::uint16_t row = 0, column = 0;
};

/// Groups that touch few states together: what one thread works on at a time, in a small dense
/// system.
struct SchurChunk {
  std::uint32_t first_group = 0, end_group = 0;
  std::uint32_t first_footprint = 0, end_footprint = 0;
  std::vector<int> states;   ///< indices, ascending
  std::vector<int> columns;  ///< the first of each in the chunk, and how many there are
  std::vector<SchurPair> pairs;

  int num_columns() const { return columns.back(); }
};

/// Where everything lies in a least-squares problem whose landmarks are eliminated first. It
/// depends on the problem alone: so do all sums over its chunks, whatever the number of threads.
struct SchurStructure {
  /// \param landmarks  blocks of kSchurLandmarkSize that no factor shares; a factor that sees one
  /// has it
  ///                   as its last parameter
  SchurStructure(const ceres::Problem& problem, const std::vector<double*>& landmarks);

  std::vector<SchurState> states;  ///< in the order of their addresses
  int num_columns = 0;
  std::vector<SchurParameter> parameters;
  std::vector<SchurFactor> factors;
  std::vector<SchurFootprint> footprints;
  std::vector<SchurRun> runs;
  std::vector<SchurGroup> groups;
  std::vector<SchurChunk> chunks;
  size_t num_landmarks = 0;  ///< the groups that have one are the first

  std::span<const SchurParameter> ParametersOf(const SchurFactor& factor) const {
    return {parameters.data() + factor.first_parameter,
            factor.cost->parameter_block_sizes().size()};
  }
  std::span<const SchurRun> RunsOf(const SchurGroup& group) const {
    return {runs.data() + group.first_run, group.end_run - group.first_run};
  }

 private:
  struct Reading;
  void AddStates(Reading& reading);
  void AddGroups(const Reading& reading);
  void AddFactor(const Reading& reading, ceres::ResidualBlockId id,
                 const std::vector<double*>& blocks);
  void CutIntoChunks();
  void Place(SchurChunk& chunk);
  void Place(const SchurChunk& chunk, SchurGroup& group);
  void FindFootprints(SchurChunk& chunk);
  std::vector<int> StatesOf(const SchurGroup& group) const;
  int ColumnsOf(const std::vector<int>& of) const;
};

}  // namespace parkade

#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/schur/schur_structure.h"

namespace parkade {

/// What the steps of a chunk's landmarks follow from, given the one of its states.
struct EliminatedLandmarks {
  /// L L^T x = -g - W s, where s is the step of the states.
  struct Landmark {
    Eigen::Matrix3d root;      ///< L
    Eigen::Vector3d gradient;  ///< g
    Eigen::Vector3d solved;    ///< L^-1 g
    Eigen::Vector3d added;     ///< damping, of the diagonal
  };
  std::vector<Landmark> landmarks;
  std::vector<double> by_states;  ///< L^-1 W of each, three rows over the columns of its group
};

/// What the factors of a chunk sum up to, over its columns.
struct SchurSums {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Matrix matrix;             ///< J^T J without landmarks; lower triangle
  Eigen::VectorXd gradient;  ///< J^T r
  Eigen::VectorXd right;     ///< -J^T r without landmarks
  Eigen::VectorXd squared_norms;
  EliminatedLandmarks eliminated;
  bool is_finite = true;
};

/// How far landmarks are held back: (scale J^T J scale + clamp(diagonal) / radius) of
/// Levenberg-Marquardt, with scales of their first linearization.
struct LandmarkDamping {
  double radius = 1;
  std::vector<Eigen::Vector3d> scales;  ///< by landmark; 0: not linearized yet
};

/// d^2 that is added to a diagonal of J^T J, as Ceres does: bounded, and relative to a scale.
double DampingOf(double squared_norm, double scale, double radius);
/// Ceres' "Jacobi scaling" of a column.
double ScaleOf(double squared_norm);

/// Half the sum of losses; infinite where a factor cannot be evaluated.
double CostOf(const SchurStructure& structure, const SchurChunk& chunk);

/// Linearizes all factors of a chunk and eliminates its landmarks. Losses count by the root of
/// their slope, as in Linearize.
SchurSums SumUp(const SchurStructure& structure, const SchurChunk& chunk, LandmarkDamping& damping);

/// Steps of a chunk's landmarks, given the one of the states, and how much lower the linearized
/// cost gets by their part of it.
double BackSubstitute(const SchurStructure& structure, const SchurChunk& chunk,
                      const EliminatedLandmarks& eliminated, const Eigen::VectorXd& state_step,
                      std::vector<Eigen::Vector3d>& steps);

}  // namespace parkade

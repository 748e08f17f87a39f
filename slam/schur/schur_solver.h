#pragma once

#include <functional>
#include <vector>

#include "slam/schur/reduced_system.h"
#include "slam/schur/schur_structure.h"

namespace parkade {

struct SchurSolverOptions {
  int max_iterations = 10;
  double function_tolerance = 1e-5;  ///< share of the cost by which a step must change it
  double trust_region = 1e6;         ///< 1 / this share of the diagonal is added at the start
};

struct SchurSummary {
  int iterations = 0;
  double final_cost = 0;
  bool is_usable = false;  ///< the cost could be evaluated, and no step after step failed
};

/// Levenberg-Marquardt over states and landmarks, landmarks eliminated one by one, in all threads;
/// the same bits for any number of them. It decides as Ceres does with a sparse Schur complement,
/// but keeps no Jacobian, only what landmarks are substituted back with, and finds the steps of
/// many states to about a hundredth (CholeskySolver::SolveSimilar). K. Levenberg, 1944; D. Brown,
/// "The bundle adjustment - progress and prospects", 1976.
class SchurSolver {
 public:
  /// \param problem  whose losses are concave in the squared error, as robust ones are
  /// \param prepare  called before factors are evaluated at new values
  SchurSolver(const ceres::Problem& problem, const std::vector<double*>& landmarks,
              std::function<void()> prepare);

  /// Moves the blocks of the problem to the optimum.
  SchurSummary Solve(const SchurSolverOptions& options);

 private:
  struct Step {
    Eigen::VectorXd states;
    std::vector<Eigen::Vector3d> landmarks;
    double fall = 0;  ///< of the linearized cost
  };

  double Cost() const;
  /// False where a factor cannot be linearized.
  bool Linearize(double radius);
  std::optional<Step> FindStep(double radius);
  std::vector<double> Values() const;
  void SetValues(const std::vector<double>& values);
  void Apply(const Step& step);

  SchurStructure structure_;
  ReducedSystem system_;
  std::function<void()> prepare_;
  LandmarkDamping damping_;
  std::vector<EliminatedLandmarks> eliminated_;  ///< by chunk, at the last linearization
  Eigen::VectorXd scales_;  ///< of the states' columns; empty before they are first linearized
};

}  // namespace parkade

#include "slam/schur/schur_chunk.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/schur/schur_kernels.h"

namespace parkade {
namespace {

constexpr double kMinDiagonal = 1e-6, kMaxDiagonal = 1e32;  // of a scaled J^T J

/// One factor at the values of its parameters, scaled by the root of its loss' slope.
class ReadFactor {
 public:
  explicit ReadFactor(const SchurStructure& structure) : structure_(structure) {}

  /// False where it cannot be evaluated.
  bool Read(const SchurFactor& factor, bool has_landmark) {
    parameters = structure_.ParametersOf(factor);
    width = structure_.footprints[factor.footprint].width;
    stride = RoundUp(width + 1);
    num_rows = factor.cost->num_residuals();
    double scale = 1;
    if (!Evaluate(factor, has_landmark, scale)) return false;
    rows.assign(static_cast<size_t>((num_rows + 1) / 2 * 2 * stride), 0.0);
    for (size_t i = 0; i < parameters.size(); ++i) {
      const SchurParameter& by = parameters[i];
      if (by.state == kHeldState) continue;
      const double* from = jacobians_[i];
      for (int row = 0; row < num_rows; ++row, from += by.size)
        for (int k = 0; k < by.tangent_size; ++k) Row(row)[by.local + k] = scale * from[k];
    }
    for (int row = 0; row < num_rows; ++row) Row(row)[width] = scale * buffer_[Index(row)];
    if (!has_landmark) return true;
    by_landmark.resize(Index(num_rows));
    for (int row = 0; row < num_rows; ++row)
      by_landmark[Index(row)] =
          scale * Eigen::Map<const Eigen::Vector3d>(jacobians_.back() + row * kSchurLandmarkSize);
    return true;
  }

  double* Row(int row) { return rows.data() + row * stride; }

  std::span<const SchurParameter> parameters;
  int num_rows = 0, width = 0, stride = 0;
  std::vector<double> rows;  ///< of the Jacobian by states, the residual after it; an even number
  std::vector<Eigen::Vector3d> by_landmark;  ///< of the Jacobian

 private:
  static size_t Index(int row) { return static_cast<size_t>(row); }

  bool Evaluate(const SchurFactor& factor, bool has_landmark, double& scale) {
    size_t size = Index(num_rows);
    for (const SchurParameter& parameter : parameters)
      size += Index(num_rows) * static_cast<size_t>(parameter.size);
    buffer_.resize(size);
    values_.clear();
    jacobians_.clear();
    double* next = buffer_.data() + num_rows;
    for (const SchurParameter& parameter : parameters) {
      values_.push_back(parameter.values);
      const bool is_landmark = has_landmark && &parameter == &parameters.back();
      jacobians_.push_back(parameter.state != kHeldState || is_landmark ? next : nullptr);
      next += num_rows * parameter.size;
    }
    if (!factor.cost->Evaluate(values_.data(), buffer_.data(), jacobians_.data())) return false;
    if (!factor.loss) return true;
    double rho[3];
    factor.loss->Evaluate(Eigen::Map<Eigen::VectorXd>(buffer_.data(), num_rows).squaredNorm(), rho);
    scale = std::sqrt(rho[1]);
    return true;
  }

  const SchurStructure& structure_;
  std::vector<double> buffer_;  // the residual, and Jacobians row by row
  std::vector<double*> jacobians_;
  std::vector<const double*> values_;
};

/// The sums over one chunk in the making.
class ChunkSums {
 public:
  ChunkSums(const SchurStructure& structure, const SchurChunk& chunk)
      : structure_(structure), chunk_(chunk), factor_(structure) {
    const int count = chunk.num_columns();
    sums_.matrix.setZero(count, count);
    sums_.gradient.setZero(count);
    sums_.right.setZero(count);
    sums_.squared_norms.setZero(count);
    size_t size = 0;
    for (std::uint32_t i = chunk.first_footprint; i < chunk.end_footprint; ++i) {
      first_products_.push_back(size);
      const int width = structure.footprints[i].width + 1;
      size += static_cast<size_t>(width * RoundUp(width));
    }
    products_.resize(size);
  }

  void Add(const SchurGroup& group, Eigen::Vector3d& scale, double radius) {
    const bool has_landmark = group.landmark != nullptr;
    landmark_.setZero();
    landmark_gradient_.setZero();
    if (has_landmark) to_landmark_.setZero(3, group.num_columns);
    for (std::uint32_t i = group.first_factor; i < group.end_factor; ++i) {
      if (!factor_.Read(structure_.factors[i], has_landmark)) {
        sums_.is_finite = false;
        return;
      }
      double* products = products_.data() +
                         first_products_[structure_.factors[i].footprint - chunk_.first_footprint];
      for (int row = 0; row < factor_.num_rows; row += 2)
        AddProducts(factor_.Row(row), factor_.Row(row + 1), factor_.width + 1, factor_.stride,
                    products);
      if (has_landmark) AddLandmark();
    }
    if (has_landmark) Eliminate(group, scale, radius);
  }

  SchurSums Take() {
    for (std::uint32_t i = chunk_.first_footprint; i < chunk_.end_footprint; ++i)
      Spread(structure_.footprints[i],
             products_.data() + first_products_[i - chunk_.first_footprint]);
    sums_.right -= sums_.gradient;
    sums_.is_finite = sums_.is_finite && sums_.right.allFinite();
    return std::move(sums_);
  }

 private:
  /// Adds products of a footprint where their columns are in the chunk.
  void Spread(const SchurFootprint& footprint, const double* products) {
    const int stride = RoundUp(footprint.width + 1);
    const std::span<const SchurParameter> parameters =
        structure_.ParametersOf(structure_.factors[footprint.factor]);
    const double* of_residual = products + footprint.width * stride;
    for (const SchurParameter& by : parameters) {
      if (by.state == kHeldState) continue;
      for (int k = 0; k < by.tangent_size; ++k) {
        const double* row = products + (by.local + k) * stride;
        sums_.gradient[by.column + k] += of_residual[by.local + k];
        sums_.squared_norms[by.column + k] += row[by.local + k];
        for (const SchurParameter& other : parameters) {
          if (other.state == kHeldState || other.local > by.local) continue;
          const int count = other.local < by.local ? other.tangent_size : k + 1;
          for (int c = 0; c < count; ++c) {
            const int i = by.column + k, j = other.column + c;
            sums_.matrix(std::max(i, j), std::min(i, j)) += row[other.local + c];
          }
        }
      }
    }
  }

  void AddLandmark() {
    for (int row = 0; row < factor_.num_rows; ++row) {
      const Eigen::Vector3d& own = factor_.by_landmark[static_cast<size_t>(row)];
      const double* by_states = factor_.Row(row);
      landmark_.noalias() += own * own.transpose();
      landmark_gradient_ += by_states[factor_.width] * own;
      for (const SchurParameter& by : factor_.parameters) {
        if (by.state == kHeldState) continue;
        for (int i = 0; i < kSchurLandmarkSize; ++i) {
          double* to = to_landmark_.data() + i * to_landmark_.cols() + by.packed;
          for (int k = 0; k < by.tangent_size; ++k) to[k] += own[i] * by_states[by.local + k];
        }
      }
    }
  }

  void Eliminate(const SchurGroup& group, Eigen::Vector3d& scale, double radius) {
    EliminatedLandmarks::Landmark landmark;
    for (int k = 0; k < kSchurLandmarkSize; ++k) {
      if (scale[k] == 0) scale[k] = ScaleOf(landmark_(k, k));
      landmark.added[k] = DampingOf(landmark_(k, k), scale[k], radius);
    }
    landmark_.diagonal() += landmark.added;
    const Eigen::LLT<Eigen::Matrix3d> factor(landmark_);
    if (factor.info() != Eigen::Success) {
      sums_.is_finite = false;
      return;
    }
    landmark.root = factor.matrixL();
    landmark.gradient = landmark_gradient_;
    landmark.solved = factor.matrixL().solve(landmark_gradient_);
    for (int i = 0; i < kSchurLandmarkSize; ++i) {
      for (int j = 0; j < i; ++j) to_landmark_.row(i) -= landmark.root(i, j) * to_landmark_.row(j);
      to_landmark_.row(i) /= landmark.root(i, i);
    }
    const std::span<const SchurRun> runs = structure_.RunsOf(group);
    for (const SchurRun& run : runs)
      sums_.right.segment(run.column, run.count) +=
          to_landmark_.middleCols(run.packed, run.count).transpose() * landmark.solved;
    SubtractProducts(to_landmark_.data(), group.num_columns, runs, sums_.matrix.data(),
                     sums_.matrix.cols());
    sums_.eliminated.landmarks.push_back(landmark);
    sums_.eliminated.by_states.insert(sums_.eliminated.by_states.end(), to_landmark_.data(),
                                      to_landmark_.data() + to_landmark_.size());
  }

  const SchurStructure& structure_;
  const SchurChunk& chunk_;
  ReadFactor factor_;
  SchurSums sums_;
  std::vector<double> products_;  // of each footprint's columns and residual, one after the other
  std::vector<size_t> first_products_;
  Eigen::Matrix3d landmark_;
  Eigen::Vector3d landmark_gradient_;
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor> to_landmark_;
};

}  // namespace

double DampingOf(double squared_norm, double scale, double radius) {
  const double diagonal = std::clamp(scale * scale * squared_norm, kMinDiagonal, kMaxDiagonal);
  return diagonal / (radius * scale * scale);
}

double ScaleOf(double squared_norm) { return 1 / (1 + std::sqrt(squared_norm)); }

double CostOf(const SchurStructure& structure, const SchurChunk& chunk) {
  double sum = 0;
  std::vector<double> residual;
  std::vector<const double*> values;
  for (std::uint32_t g = chunk.first_group; g < chunk.end_group; ++g) {
    const SchurGroup& group = structure.groups[g];
    for (std::uint32_t i = group.first_factor; i < group.end_factor; ++i) {
      const SchurFactor& factor = structure.factors[i];
      values.clear();
      for (const SchurParameter& parameter : structure.ParametersOf(factor))
        values.push_back(parameter.values);
      residual.resize(static_cast<size_t>(factor.cost->num_residuals()));
      if (!factor.cost->Evaluate(values.data(), residual.data(), nullptr))
        return std::numeric_limits<double>::infinity();
      double rho[3] = {
          Eigen::Map<Eigen::VectorXd>(residual.data(), factor.cost->num_residuals()).squaredNorm()};
      if (factor.loss) factor.loss->Evaluate(rho[0], rho);
      sum += rho[0] / 2;
    }
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

SchurSums SumUp(const SchurStructure& structure, const SchurChunk& chunk,
                LandmarkDamping& damping) {
  ChunkSums sums(structure, chunk);
  Eigen::Vector3d none;
  for (std::uint32_t g = chunk.first_group; g < chunk.end_group; ++g)
    sums.Add(structure.groups[g], g < damping.scales.size() ? damping.scales[g] : none,
             damping.radius);
  return sums.Take();
}

double BackSubstitute(const SchurStructure& structure, const SchurChunk& chunk,
                      const EliminatedLandmarks& eliminated, const Eigen::VectorXd& state_step,
                      std::vector<Eigen::Vector3d>& steps) {
  Eigen::VectorXd of_chunk(chunk.num_columns());
  for (size_t i = 0; i < chunk.states.size(); ++i) {
    const SchurState& state = structure.states[static_cast<size_t>(chunk.states[i])];
    of_chunk.segment(chunk.columns[i], state.tangent_size) =
        state_step.segment(state.column, state.tangent_size);
  }
  double fall = 0;
  size_t next = 0;
  const double* by_states = eliminated.by_states.data();
  for (std::uint32_t g = chunk.first_group; g < chunk.end_group; ++g) {
    const SchurGroup& group = structure.groups[g];
    if (!group.landmark) continue;
    const EliminatedLandmarks::Landmark& landmark = eliminated.landmarks[next++];
    Eigen::Vector3d right = -landmark.solved;
    for (const SchurRun& run : structure.RunsOf(group))
      for (int i = 0; i < kSchurLandmarkSize; ++i)
        right[i] -= Eigen::Map<const Eigen::VectorXd>(
                        by_states + i * group.num_columns + run.packed, run.count)
                        .dot(of_chunk.segment(run.column, run.count));
    by_states += kSchurLandmarkSize * group.num_columns;
    const Eigen::Vector3d step =
        landmark.root.transpose().triangularView<Eigen::Upper>().solve(right);
    steps[g] = step;
    fall += (step.dot(landmark.added.cwiseProduct(step)) - step.dot(landmark.gradient)) / 2;
  }
  return fall;
}

}  // namespace parkade

#include "slam/schur/schur_chunk.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

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
    rows = factor.cost->num_residuals();
    const auto height = static_cast<size_t>(rows);
    size_t size = height;
    for (const SchurParameter& parameter : parameters)
      size += height * static_cast<size_t>(parameter.size);
    buffer_.resize(size);
    values_.clear();
    jacobians.clear();
    double* next = buffer_.data() + height;
    for (const SchurParameter& parameter : parameters) {
      values_.push_back(parameter.values);
      const bool is_landmark = has_landmark && &parameter == &parameters.back();
      jacobians.push_back(parameter.state != kHeldState || is_landmark ? next : nullptr);
      next += height * static_cast<size_t>(parameter.size);
    }
    if (!factor.cost->Evaluate(values_.data(), buffer_.data(), jacobians.data())) return false;
    if (factor.loss) {
      double rho[3];
      factor.loss->Evaluate(Eigen::Map<Eigen::VectorXd>(buffer_.data(), rows).squaredNorm(), rho);
      const double scale = std::sqrt(rho[1]);
      for (double& value : buffer_) value *= scale;  // of held parameters, too: nobody looks there
    }
    return true;
  }

  const double* residual() const { return buffer_.data(); }

  std::span<const SchurParameter> parameters;
  std::vector<double*> jacobians;  ///< rows x size each, row by row; null: held
  int rows = 0;

 private:
  const SchurStructure& structure_;
  std::vector<double> buffer_;
  std::vector<const double*> values_;
};

/// sum += a^T b for blocks of Jacobians; rows of `sum` are `stride` apart.
template <int kSizeA, int kSizeB>
void AddProduct(const double* a, int size_a, const double* b, int size_b, int rows, double* sum,
                Eigen::Index stride, int width_a = kSizeA, int width_b = kSizeB) {
  for (int row = 0; row < rows; ++row, a += size_a, b += size_b)
    for (int i = 0; i < (kSizeA > 0 ? kSizeA : width_a); ++i)
      for (int j = 0; j < (kSizeB > 0 ? kSizeB : width_b); ++j) sum[i * stride + j] += a[i] * b[j];
}

/// The sums over one chunk in the making.
class ChunkSums {
 public:
  ChunkSums(const SchurStructure& structure, const SchurChunk& chunk)
      : structure_(structure), factor_(structure) {
    const int count = chunk.num_columns();
    sums_.matrix.setZero(count, count);
    sums_.gradient.setZero(count);
    sums_.right.setZero(count);
    sums_.squared_norms.setZero(count);
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
      AddStates();
      if (has_landmark) AddLandmark();
    }
    if (has_landmark) Eliminate(group, scale, radius);
  }

  SchurSums Take() {
    sums_.right -= sums_.gradient;
    sums_.is_finite = sums_.is_finite && sums_.right.allFinite();
    return std::move(sums_);
  }

 private:
  void AddStates() {
    const Eigen::Index stride = sums_.matrix.cols();
    for (size_t i = 0; i < factor_.parameters.size(); ++i) {
      const SchurParameter& by = factor_.parameters[i];
      if (by.state == kHeldState) continue;
      const double* a = factor_.jacobians[i];
      for (int row = 0; row < factor_.rows; ++row)
        for (int k = 0; k < by.tangent_size; ++k) {
          const double value = a[row * by.size + k];
          sums_.gradient[by.column + k] += value * factor_.residual()[row];
          sums_.squared_norms[by.column + k] += value * value;
        }
      for (size_t j = 0; j < factor_.parameters.size(); ++j) {
        const SchurParameter& other = factor_.parameters[j];
        if (other.state == kHeldState || other.column > by.column) continue;
        double* sum = sums_.matrix.data() + by.column * stride + other.column;
        const double* b = factor_.jacobians[j];
        if (by.tangent_size == 6 && other.tangent_size == 6)
          AddProduct<6, 6>(a, by.size, b, other.size, factor_.rows, sum, stride);
        else
          AddProduct<0, 0>(a, by.size, b, other.size, factor_.rows, sum, stride, by.tangent_size,
                           other.tangent_size);
      }
    }
  }

  void AddLandmark() {
    const double* own = factor_.jacobians.back();
    for (int row = 0; row < factor_.rows; ++row) {
      const Eigen::Map<const Eigen::Vector3d> by_landmark(own + row * kSchurLandmarkSize);
      landmark_.noalias() += by_landmark * by_landmark.transpose();
      landmark_gradient_ += factor_.residual()[row] * by_landmark;
    }
    for (size_t i = 0; i + 1 < factor_.parameters.size(); ++i) {
      const SchurParameter& by = factor_.parameters[i];
      if (by.state == kHeldState) continue;
      AddProduct<3, 0>(own, kSchurLandmarkSize, factor_.jacobians[i], by.size, factor_.rows,
                       to_landmark_.data() + by.packed, to_landmark_.cols(), 3, by.tangent_size);
    }
  }

  void Eliminate(const SchurGroup& group, Eigen::Vector3d& scale, double radius) {
    for (int k = 0; k < kSchurLandmarkSize; ++k) {
      if (scale[k] == 0) scale[k] = ScaleOf(landmark_(k, k));
      landmark_(k, k) += DampingOf(landmark_(k, k), scale[k], radius);
    }
    const Eigen::LLT<Eigen::Matrix3d> factor(landmark_);
    if (factor.info() != Eigen::Success) {
      sums_.is_finite = false;
      return;
    }
    factor.matrixL().solveInPlace(to_landmark_);
    const Eigen::Vector3d solved = factor.matrixL().solve(landmark_gradient_);
    const Eigen::Index stride = sums_.matrix.cols(), count = to_landmark_.cols();
    const double *x = to_landmark_.data(), *y = x + count, *z = y + count;
    for (std::uint32_t i = group.first_run; i < group.end_run; ++i) {
      const SchurRun& run = structure_.runs[i];
      for (int k = 0; k < run.count; ++k) {
        const int at = run.packed + k;
        sums_.right[run.column + k] += to_landmark_.col(at).dot(solved);
        double* row = sums_.matrix.data() + (run.column + k) * stride;
        for (std::uint32_t j = group.first_run; j <= i; ++j) {
          const SchurRun& other = structure_.runs[j];
          const int length = j < i ? other.count : k + 1;
          double* to = row + other.column;
          const double *u = x + other.packed, *v = y + other.packed, *w = z + other.packed;
          for (int c = 0; c < length; ++c) to[c] -= x[at] * u[c] + y[at] * v[c] + z[at] * w[c];
        }
      }
    }
  }

  const SchurStructure& structure_;
  ReadFactor factor_;
  SchurSums sums_;
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
                      const LandmarkDamping& damping, const Eigen::VectorXd& state_step,
                      std::vector<Eigen::Vector3d>& steps) {
  double fall = 0;
  ReadFactor factor(structure);
  for (std::uint32_t g = chunk.first_group; g < chunk.end_group; ++g) {
    const SchurGroup& group = structure.groups[g];
    if (!group.landmark) continue;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero(), right = Eigen::Vector3d::Zero();
    for (std::uint32_t i = group.first_factor; i < group.end_factor; ++i) {
      if (!factor.Read(structure.factors[i], true)) continue;
      for (int row = 0; row < factor.rows; ++row) {
        const Eigen::Map<const Eigen::Vector3d> own(factor.jacobians.back() +
                                                    row * kSchurLandmarkSize);
        double moved = 0;
        for (size_t k = 0; k + 1 < factor.parameters.size(); ++k) {
          const SchurParameter& by = factor.parameters[k];
          if (by.state == kHeldState) continue;
          const int column = structure.states[static_cast<size_t>(by.state)].column;
          const double* jacobian = factor.jacobians[k] + row * by.size;
          for (int c = 0; c < by.tangent_size; ++c) moved += jacobian[c] * state_step[column + c];
        }
        normal.noalias() += own * own.transpose();
        gradient += factor.residual()[row] * own;
        right -= (factor.residual()[row] + moved) * own;
      }
    }
    Eigen::Vector3d added;
    for (int k = 0; k < kSchurLandmarkSize; ++k)
      added[k] = DampingOf(normal(k, k), damping.scales[g][k], damping.radius);
    normal.diagonal() += added;
    const Eigen::Vector3d step = normal.llt().solve(right);
    steps[g] = step;
    fall += (step.dot(added.cwiseProduct(step)) - step.dot(gradient)) / 2;
  }
  return fall;
}

}  // namespace parkade

#include "slam/factors/linear_prior.h"

#include <cassert>
#include <tuple>

namespace parkade {
namespace {

constexpr double kMinRoot = 1e-9;  // of a diagonal of the prior: a direction nothing is known about

}  // namespace

int StateName::Size() const {
  switch (kind) {
    case Kind::kPose:
    case Kind::kExtrinsics: return kPoseSize;
    case Kind::kMotion: return kMotionSize;
    case Kind::kTiming: return kTimingSize;
    case Kind::kWheelScale: return 1;
  }
  return 0;
}

std::strong_ordering StateName::operator<=>(const StateName& other) const {
  const auto key = [](const StateName& name) {
    const int group = name.IsOfNode() ? 0 : name.kind == Kind::kWheelScale ? 1 : 2;
    return std::tuple(group, name.number, static_cast<int>(name.kind));
  };
  return key(*this) <=> key(other);
}

void PriorBlock::Deviation(const double* values, double* deviation) const {
  if (name.IsPose())
    PoseManifold().Minus(values, at.data(), deviation);
  else
    for (int k = 0; k < Size(); ++k) deviation[k] = values[k] - at[static_cast<size_t>(k)];
}

int LinearPrior::Columns() const {
  int columns = 0;
  for (const PriorBlock& block : blocks) columns += block.TangentSize();
  return columns;
}

int LinearPrior::ColumnOf(const StateName& name) const {
  int column = 0;
  for (const PriorBlock& block : blocks) {
    if (block.name == name) return column;
    column += block.TangentSize();
  }
  assert(false && "the prior does not speak of this state");
  return 0;
}

Eigen::MatrixXd LinearPrior::ModelCovariance() const {
  Eigen::MatrixXd root = sqrt_information;
  root.diagonal().array() += (root.diagonal().array().abs() < kMinRoot).cast<double>() * kMinRoot;
  const Eigen::MatrixXd inverse = root.triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXd::Identity(root.rows(), root.cols()));
  return inverse * inverse.transpose();
}

Eigen::MatrixXd LinearPrior::Covariance() const {
  const Eigen::MatrixXd model = ModelCovariance();
  const Eigen::MatrixXd sensitivity = model * score_sensitivity;
  return model * score_covariance * model + sensitivity * sensitivity.transpose();
}

ScoreElimination EliminateScores(const Eigen::MatrixXd& score_covariance,
                                 const Eigen::MatrixXd& score_sensitivity,
                                 const Eigen::MatrixXd& root, const Eigen::MatrixXd& to_kept) {
  const Eigen::Index dropped = root.cols(), kept = to_kept.cols();
  // W = root^-T M_dropped,all: covariance of z with all scores.
  const Eigen::MatrixXd with_all =
      root.transpose().triangularView<Eigen::Lower>().solve(score_covariance.topRows(dropped));
  ScoreElimination result;
  result.dropped = root.transpose()
                       .triangularView<Eigen::Lower>()
                       .solve(with_all.leftCols(dropped).transpose())
                       .transpose();
  const Eigen::MatrixXd with_kept = with_all.rightCols(kept);
  result.cross = with_kept.transpose() - to_kept.transpose() * result.dropped;
  const Eigen::MatrixXd mixed = to_kept.transpose() * with_kept;
  result.kept = score_covariance.bottomRightCorner(kept, kept) - mixed - mixed.transpose() +
                to_kept.transpose() * result.dropped * to_kept;
  result.dropped_sensitivity =
      root.transpose().triangularView<Eigen::Lower>().solve(score_sensitivity.topRows(dropped));
  result.kept_sensitivity =
      score_sensitivity.bottomRows(kept) - to_kept.transpose() * result.dropped_sensitivity;
  return result;
}

LinearPriorCost::LinearPriorCost(const LinearPrior* prior) : prior_(prior) {
  set_num_residuals(static_cast<int>(prior->sqrt_information.rows()));
  for (const PriorBlock& block : prior->blocks)
    mutable_parameter_block_sizes()->push_back(block.Size());
}

bool LinearPriorCost::Evaluate(double const* const* parameters, double* residuals,
                               double** jacobians) const {
  Eigen::VectorXd change(prior_->sqrt_information.cols());
  int column = 0;
  for (size_t i = 0; i < prior_->blocks.size(); ++i) {
    const PriorBlock& block = prior_->blocks[i];
    block.Deviation(parameters[i], change.data() + column);
    if (jacobians && jacobians[i]) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian(
          jacobians[i], num_residuals(), block.Size());
      jacobian.leftCols(block.TangentSize()) =
          prior_->sqrt_information.middleCols(column, block.TangentSize());
      if (block.TangentSize() < block.Size()) jacobian.rightCols<1>().setZero();
    }
    column += block.TangentSize();
  }
  Eigen::Map<Eigen::VectorXd> residual(residuals, num_residuals());
  residual = prior_->offset;
  residual.noalias() += prior_->sqrt_information * change;
  return true;
}

}  // namespace parkade
